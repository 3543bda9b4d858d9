// What    Boxes about a point, computed in double or float, that contain what they are to whatever the
//         rounding.
#pragma once

#include "base/bounds.h"
#include "base/box.h"
#include "base/vec.h"

namespace kdray::primitives {

// The smallest box of floats that contains center -+ reach.
Box box_around(const vec3& center, const dvec3& reach);

// The same, wider than any rounding of a reach that was computed in float.
Box wide_box_around(const vec3& center, const vec3& reach);

// How far a disc of radius 1 across an axis reaches along x, y and z: sqrt(1 - w_i^2) for the unit axis w.
// Written as sqrt((w_j^2 + w_k^2) / w^2), which has no cancellation when the axis is nearly parallel to i.
dvec3 disc_reach(const dvec3& axis);

}  // namespace kdray::primitives
