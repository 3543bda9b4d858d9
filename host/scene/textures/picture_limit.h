// What    Makes a scene's pictures smaller until their texels, mipmaps included, fit a number of bytes: the
//         largest picture that is left is replaced by its first mipmap, again and again.
// Shape   A picture that textures show both as codes of sRGB and as linear is halved as the first of them has
//         it. Texels are four bytes; those of mipmaps are counted where a texture has some.
// Errors  None. Pictures of one texel stay, so a limit may be missed; the answer's bytes tell.
#pragma once

#include <cstddef>
#include <cstdint>

#include "scene/textures/texturing.h"

namespace kdray::scene {

struct LimitedPictures {
  std::size_t n_halved = 0;  // pictures that are smaller now
  std::uint64_t bytes_before = 0, bytes = 0;
};

std::uint64_t picture_bytes(const Texturing& texturing);

LimitedPictures limit_pictures(Texturing& texturing, std::uint64_t most_bytes);

}  // namespace kdray::scene
