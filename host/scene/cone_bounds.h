// What    How far a disc of radius 1 across an axis reaches along x, y and z: sqrt(1 - w_i^2) for the unit
//         axis w.
// Shape   Written as sqrt((w_j^2 + w_k^2) / w^2), which has no cancellation when the axis is nearly parallel
//         to i.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/vec.h"

namespace kdray::scene {

inline dvec3 disc_reach(const dvec3& axis) {
  // Scaled to at most 1 first, so that no square overflows or vanishes.
  const double largest = std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
  if (!(largest > 0)) return dvec3(1);
  const dvec3 w = axis / largest;
  const dvec3 square = w * w;
  const double sum = square.x + square.y + square.z;
  return {std::sqrt((square.y + square.z) / sum), std::sqrt((square.x + square.z) / sum),
          std::sqrt((square.x + square.y) / sum)};
}

}  // namespace kdray::scene
