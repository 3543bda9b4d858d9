// What    A scene's paint -> the arrays of kernels/layout/paint.layout.h.
// Shape   Each picture that a texture shows lies in the texels once, behind sRGB's curve. Corners' colours
//         and coordinates come in the order of the geometry's triangles; of two sets of coordinates those
//         of one triangle follow each other.
// Errors  ErrorCode::input when the pictures have more texels than words can number.
#pragma once

#include "accel/flatten/flatten.h"

namespace kdray::flatten {

void pack_paint(const scene::Scene& scene, const scene::Geometry& geometry, FlatScene& flat);

// What a mesh's triangles have at their corners, as the paint of the scene that it is in asks for.
void pack_corners_of(const scene::Paint& paint, const scene::Scene& mesh, const scene::Geometry& geometry,
                     FlatScene& flat);

}  // namespace kdray::flatten
