// What    A scene's textures and material maps -> the arrays of kernels/layout/textures.layout.h.
// Shape   Each picture that a texture shows lies in the texels once, behind sRGB's curve. Corners' colours
//         and coordinates come in the order of the geometry's triangles; of two sets of coordinates those
//         of one triangle follow each other.
// Errors  ErrorCode::input when the pictures have more texels than words can number.
#pragma once

#include "accel/flatten/flatten.h"

namespace kdray::flatten {

void pack_textures_of(const scene::Scene& scene, const scene::Geometry& geometry, FlatScene& flat);

// What a mesh's triangles have at their corners, as the textures of the scene that it is in ask for.
void pack_corners_of(const scene::Texturing& texturing, const scene::Scene& mesh,
                     const scene::Geometry& geometry, FlatScene& flat);

}  // namespace kdray::flatten
