// What    The half-open rule (kernels/intersect/crossing.clh) once more, by its definition, for one ray and
//         all triangles of a scene: corners in float as the kernels have them, signs exactly, in double.
// Shape   Floats' products are exact in double, so that comparing two of them is all that a sign takes. t is
//         found in double from the corners as they are displaced: the kernels' t is that within a few ulp of
//         the largest coordinate in play.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kdray/ray.h"
#include "layout/primitives.layout.h"

namespace kdray::test {

struct RuleHit {
  double t;
  double error;  // that t may be off by
  std::uint32_t primitive;
};

// Of the line, in ascending order.
std::vector<RuleHit> crossed_by_line(const Ray& ray, std::span<const layout::Triangle> triangles);

}  // namespace kdray::test
