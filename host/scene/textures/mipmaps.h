// What    The smaller forms of pictures, by which they are shown where they are far away, or where memory is
//         short.
// Shape   Each level is half as wide and as high as the one before, rounded down, but one texel at least; the
//         last has one. A texel is the mean of what it covers of the level before, whose texels at an odd
//         side's borders count by the share that is covered.
// Why     Whole numbers from the bytes on, so that they are the same on every machine: means are taken of
//         65535ths of linear light, rounded to the nearest; of these the next level is made, and the nearest
//         byte of each is stored.
// Units   Texels are words, as kernels/layout/textures.layout.h has them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/textures/texturing.h"

namespace kdray::scene {

struct LevelSize {
  std::uint32_t width = 0, height = 0;
  std::size_t texels() const { return std::size_t{width} * height; }
};

// Returns the picture's own size, and those of its mipmaps.
std::vector<LevelSize> level_sizes(std::uint32_t width, std::uint32_t height);

// Writes the levels from `first_level` on, one behind the other. `curved`: colours are codes of sRGB.
void write_levels(const Picture& picture, bool curved, std::size_t first_level, std::size_t n_levels,
                  std::span<std::uint32_t> out);

// limit_pictures() makes a scene's pictures smaller until their texels, mipmaps included, fit a number of
// bytes: the largest picture that is left is replaced by its first mipmap, again and again. A picture that
// textures show both as codes of sRGB and as linear is halved as the first of them has it. Texels are four
// bytes; those of mipmaps are counted where a texture has some. Pictures of one texel stay, so that a limit
// may be missed; `bytes` tells.
struct LimitedPictures {
  std::size_t n_halved = 0;  // pictures that are smaller now
  std::uint64_t bytes_before = 0, bytes = 0;
};

std::uint64_t picture_bytes(const Texturing& texturing);

LimitedPictures limit_pictures(Texturing& texturing, std::uint64_t most_bytes);

}  // namespace kdray::scene
