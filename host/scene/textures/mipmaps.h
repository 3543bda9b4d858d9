// What    The smaller forms of pictures, by which they are shown where they are far away.
// Shape   Each level is half as wide and as high as the one before, rounded down, but one texel at least; the
//         last has one. A texel is the mean of what it covers of the level before, whose texels at an odd
//         side's borders count by the share that is covered.
// Why     Whole numbers from the bytes on, so that they are the same on every machine: means are taken of
//         65535ths of linear light, rounded to the nearest; of these the next level is made, and the nearest
//         byte of each is stored.
// Units   Texels are words, as kernels/layout/textures.layout.h has them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/textures/texturing.h"

namespace kdray::scene {

struct LevelSize {
  std::uint32_t width = 0, height = 0;
  std::size_t texels() const { return std::size_t{width} * height; }
};

// The picture's own size, and those of its mipmaps.
std::vector<LevelSize> level_sizes(std::uint32_t width, std::uint32_t height);

// Writes the levels from `first_level` on, one behind the other. `curved`: colours are codes of sRGB.
void write_levels(const Picture& picture, bool curved, std::size_t first_level, std::size_t n_levels,
                  std::span<std::uint32_t> out);

}  // namespace kdray::scene
