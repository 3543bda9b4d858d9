// What    A scene's textures, material maps and sky -> the arrays of kernels/layout/textures.layout.h and
//         kernels/layout/sky.layout.h.
// Shape   Each picture that a texture shows lies in the texels once, its levels one behind the other, behind
//         sRGB's curve. A picture whose colours are shown as codes of sRGB by one texture and as linear by
//         another has mipmaps of both kinds; without mipmaps its bytes serve both. Corners' colours and
//         coordinates come in the order of the geometry's triangles; of two sets of coordinates those of one
//         triangle follow each other.
// Errors  ErrorCode::input when the pictures have more texels than words can number.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/flatten/flatten.h"
#include "base/memory.h"
#include "layout/textures.layout.h"
#include "scene/textures/mipmaps.h"
#include "scene/textures/sky.h"
#include "scene/textures/texturing.h"

namespace kdray::flatten {

void pack_textures_of(const scene::Scene& scene, const scene::Geometry& geometry, FlatScene& flat);

// Packs what a mesh's triangles have at their corners, as far as the textures of the scene that it is in need
// it.
void pack_corners_of(const scene::Texturing& texturing, const scene::Scene& mesh,
                     const scene::Geometry& geometry, FlatScene& flat);

// Leaves the arrays empty where the scene has no sky.
void pack_sky(const scene::Sky& sky, FlatScene& flat);

// The levels of one picture.
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

// Finds out which texels the textures need, and where they lie.
TexelPlan plan_texels(const scene::Texturing& texturing);

Array<layout::u32> pack_texels(const scene::Texturing& texturing, const TexelPlan& plan);

}  // namespace kdray::flatten
