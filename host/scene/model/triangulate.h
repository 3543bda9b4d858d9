// What    Cuts a simple polygon, convex or concave, into triangles by clipping ears (Meisters 1975).
// Shape   n >= 3 corners in order -> always n - 2 triples of corner numbers, keeping the polygon's
//         orientation. A polygon whose first corner sees all others (a convex one) becomes the fan of that
//         corner. Corners on a straight line become corners of real triangles, not of flat ones, so that
//         neighbours share whole edges.
// Cost    About n log n, whatever the polygon's shape.
// Errors  None: a polygon that is not simple or has no area still gives n - 2 triangles; one with a corner
//         that is not finite gives them of that corner alone (settle_normals.h). One of over some ten
//         thousand corners that crosses itself all over is cut for a few seconds; its rest becomes a fan, and
//         `finished` false.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace kdray::scene {

std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const dvec3> corners,
                                                      bool* finished = nullptr);

}  // namespace kdray::scene
