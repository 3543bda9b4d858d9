// What    Small pictures as PNG, for tests of textures.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/image/png.h"
#include "scene/textures/texturing.h"

namespace kdray::test {

// Rows from the top, `channels` samples for each pixel.
inline std::string png(int width, int height, int channels, const std::vector<std::uint16_t>& samples,
                       int bits = 8) {
  return image::encode_png({width, height, channels, bits, samples}, {});
}

// Two columns, two rows: red, green; blue, white.
inline std::string four_colors() {
  return png(2, 2, 3, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255});
}

inline std::vector<std::uint8_t> bytes_of(const scene::Picture& picture) {
  return {picture.texels.begin(), picture.texels.end()};
}

}  // namespace kdray::test
