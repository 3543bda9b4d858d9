// What    Newell's teapot as 32 bicubic Bezier patches.
// Shape   patch[row][column]: rows run along the profile (or the tube), columns around it.
// Source  M. Newell, "The utilization of procedure models in digital image synthesis", 1975, with F. Crow's
//         bottom (IEEE CG&A 7(1), 1987); here by its symmetries: profiles turned in four quarters, tubes
//         mirrored in y.
#pragma once

#include <array>
#include <vector>

#include "base/vec.h"

namespace kdray::generate {

using BezierPatch = std::array<std::array<dvec3, 4>, 4>;

std::vector<BezierPatch> teapot_patches();

}  // namespace kdray::generate
