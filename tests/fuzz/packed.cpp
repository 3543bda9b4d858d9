// Files that are packed by gzip or xz: the first byte says which.
#include "fuzz/target.h"
#include "scene/import/files.h"

KDRAY_FUZZ(packed, bytes) {
  using namespace kdray;
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  fuzz::Input input(bytes);
  const char* const name = input.take<std::uint8_t>() % 2 == 0 ? "a.nff.gz" : "a.nff.xz";
  return fuzz::is_read([&] {
    if (scene::unpacked(std::string(input.rest()), name, kMostBytes).size() > kMostBytes)
      fuzz::fail("more bytes than were allowed");
  });
}
