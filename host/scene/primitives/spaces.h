// What    The moves that leave a shape the shape that it is: placements in a file. (math/local_space.h has
//         the space of the tree and the kernels.)
#pragma once

#include "base/local_space.h"
#include "base/vec.h"

namespace kdray::primitives {

// A rotation, mirror and uniform scale, then a move: what leaves a sphere a sphere.
struct Similarity {
  dmat4 matrix;
  double factor;  // by which it enlarges

  dvec3 point(const dvec3& p) const { return dvec3(matrix * glm::dvec4(p, 1)); }
  dvec3 direction(const dvec3& d) const { return dmat3(matrix) * d / factor; }
};

}  // namespace kdray::primitives
