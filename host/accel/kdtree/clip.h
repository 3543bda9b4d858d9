// What    "Perfect splits": the bounds of the part of a primitive's surface inside a cell.
// Shape   All bounds contain what they bound, whatever the rounding (docs/design/clipping.md has the proofs);
//         an empty result proves that the surface does not meet the closed cell.
#pragma once

#include "accel/kdtree/reference.h"
#include "scene/model/geometry.h"

namespace kdray::kdtree {

struct SplitBounds {
  Bounds below, above;
};

// Clips a reference. `r` is bounded inside `cell`; the plane is inside its bounds.
SplitBounds clip_to_sides(const scene::Geometry& geometry, const BoundedRef& r, const Bounds& cell, int axis,
                          float position);

// Does the same for a triangle. `known` are bounds of the part inside the cell, found before. (For a shape
// they are a region to clip it to: primitives/<kind>.cpp.)
SplitBounds clip_triangle(const scene::TriangleGeometry& t, const Bounds& known, const Bounds& cell, int axis,
                          float position);

}  // namespace kdray::kdtree
