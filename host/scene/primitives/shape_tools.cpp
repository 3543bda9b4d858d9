#include "scene/primitives/shape_tools.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/box.h"
#include "base/error.h"
#include "scene/primitives/kinds.h"

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

bool hits_again(const Quadratic& q, double t, bool outside) {
  if (!(q.a > 0)) return false;
  if (outside) return q.c < 0 || q.b > 0;
  if (q.c > 0) return true;
  const double root = std::sqrt(std::max(0.0, q.b * q.b - q.a * q.c));
  const double exit = q.b > 0 ? -q.c / (q.b + root) : (root - q.b) / q.a;
  return t < 0.5 * exit;
}

void throw_unknown_kind(std::uint32_t number) {
  throw Error(ErrorCode::internal, "no kind of primitive has the number " + std::to_string(number));
}

}  // namespace kdray::primitives
