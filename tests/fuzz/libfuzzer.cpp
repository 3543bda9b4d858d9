// What    libFuzzer's entry into a program of one target.
#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  // No null pointer for an empty input, as no reader is given one.
  kdray::fuzz::targets().front().read(
      size == 0 ? std::string_view("") : std::string_view(reinterpret_cast<const char*>(data), size));
  return 0;
}
