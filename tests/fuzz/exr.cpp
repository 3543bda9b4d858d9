// EXR as `kdray compare` reads it; what is read is written, and read again.
#include "io/image/exr.h"

#include "fuzz/target.h"

KDRAY_FUZZ(exr, bytes) {
  using namespace kdray;
  constexpr std::uint64_t kMostPixels = 1 << 12;
  return fuzz::is_read([&] {
    const image::Image read = image::decode_exr(bytes, "a.exr", kMostPixels);
    if (read.pixels.size() > kMostPixels) fuzz::fail("more pixels than were allowed");
    if (read.pixels.empty()) return;
    const image::Image again = image::decode_exr(image::encode_exr(read, {}), "again.exr");
    if (again.width != read.width || again.height != read.height) fuzz::fail("another size when read again");
  });
}
