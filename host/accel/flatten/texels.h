// What    Which texels a scene's textures need, and where they lie: for each picture that is shown, its
//         levels one behind the other, behind sRGB's curve.
// Shape   A picture whose colours are shown as codes of sRGB by one texture and as linear by another has
//         mipmaps of both kinds; without mipmaps its bytes serve both.
// Errors  ErrorCode::input when there are more texels than words can number.
#pragma once

#include <cstdint>
#include <vector>

#include "base/array.h"
#include "layout/textures.layout.h"
#include "scene/textures/mipmaps.h"
#include "scene/textures/texturing.h"

namespace kdray::flatten {

struct Chain {
  std::uint32_t picture = 0;
  bool curved = false, mipmaps = false;
  std::size_t first = 0;       // texel
  scene::LevelSize size = {};  // of the first level that is there
  std::size_t n_levels = 1;    // that are there
  std::size_t n_texels = 0;    // of all of these
};

struct TexelPlan {
  std::vector<Chain> chains;
  std::vector<std::size_t> chain_of;  // by texture
  std::size_t n_texels = 0;           // with the curve
};

TexelPlan plan_texels(const scene::Texturing& texturing);

Array<layout::u32> pack_texels(const scene::Texturing& texturing, const TexelPlan& plan);

}  // namespace kdray::flatten
