// The pictures of skies, which their first bytes tell apart: Radiance HDR, EXR, PNG, JPEG.
#include "scene/textures/sky.h"

#include <algorithm>
#include <cmath>

#include "fuzz/target.h"

KDRAY_FUZZ(sky, bytes) {
  using namespace kdray;
  return fuzz::is_read([&] {
    std::vector<std::string> warnings;
    const auto sky = scene::decode_sky_picture(bytes, "a sky", warnings);
    if (sky->rgb.size() != std::size_t{3} * sky->width * sky->height)
      fuzz::fail("a sky whose numbers are not as many as its size says");
    if (!std::ranges::all_of(sky->rgb, [](float v) { return std::isfinite(v) && v >= 0; }))
      fuzz::fail("a sky of light that is no number");
  });
}
