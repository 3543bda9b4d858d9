#include "scene/primitives/box_around.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/rounding.h"

namespace kdray::primitives {

namespace {

// a + b rounded down to float: the sum in double and, where that rounded up, one step below it first.
float sum_down(double a, double b) {
  double sum = a + b;
  const double back = sum - a;
  const double lost = (a - (sum - back)) + (b - back);  // exactly what the rounding took
  if (lost < 0) sum = std::nextafter(sum, -std::numeric_limits<double>::infinity());
  return round_down(sum);
}

}  // namespace

Box box_around(const vec3& center, const dvec3& reach) {
  Box box;
  for (int i = 0; i < 3; ++i) {
    box.lo[i] = sum_down(center[i], -reach[i]);
    box.hi[i] = -sum_down(-static_cast<double>(center[i]), -reach[i]);
  }
  return box;
}

Box wide_box_around(const vec3& center, const vec3& reach) {
  const vec3 wide = reach + 1e-6f * (glm::abs(center) + reach);
  return {center - wide, center + wide};
}

dvec3 disc_reach(const dvec3& axis) {
  // Scaled to at most 1 first, so that no square overflows or vanishes.
  const double largest = std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
  if (!(largest > 0)) return dvec3(1);
  const dvec3 w = axis / largest;
  const dvec3 square = w * w;
  const double sum = square.x + square.y + square.z;
  return {std::sqrt((square.y + square.z) / sum), std::sqrt((square.x + square.z) / sum),
          std::sqrt((square.x + square.y) / sum)};
}

}  // namespace kdray::primitives
