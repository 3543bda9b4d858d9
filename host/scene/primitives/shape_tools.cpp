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
  const auto [sum, lost] = exact_sum(a, b);
  return round_down(lost < 0 ? std::nextafter(sum, -std::numeric_limits<double>::infinity()) : sum);
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

dvec3 any_across(const dvec3& axis) {
  return glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
}

// Twice, since what is left of a way along the axis is mostly rounding.
dvec3 unit_across(const dvec3& axis, const dvec3& way) {
  const auto across = [&](const dvec3& v) { return v - glm::dot(v, axis) * axis; };
  const dvec3 once = across(way);
  if (once == dvec3(0)) return any_across(axis);
  const dvec3 twice = across(safe_normalize(once));
  return twice == dvec3(0) ? any_across(axis) : glm::normalize(twice);
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

// In two steps: after the first a line from far off is as far from the nearest place as a double loses of its
// way. (The way from the place and what is added to it are exact before they are rounded once.)
LineNear::LineNear(const dvec3& place, const Line& line)
    : line_(line), direction_(line.direction), slack_(0x1p-48 * largest_component(place)) {
  const dvec3& d = line.direction;
  const double square = glm::dot(d, d);
  const auto forward = [&](const dvec3& to_place) { return glm::dot(to_place, d) / square; };
  const double first = forward(place - line.origin);
  for (int k = 0; k < 3; ++k)
    from_[k] = exact_sum(line.origin[k], -place[k]) + exact_product(first, d[k]) + line.rest[k];
  const double second = forward(-dvec3(from_));
  for (int k = 0; k < 3; ++k) from_[k] += exact_product(second, d[k]);
  ahead_ = exact_sum(first, second);
}

namespace {

constexpr double kMore = 1 + 0x1p-30, kRounding = 0x1p-40;  // far more than doubles lose

}  // namespace

bool LineNear::misses(double reach) const {
  const dvec3 from(from_);
  reach = reach * kMore + slack_;
  if (glm::dot(from, from) > reach * reach) return true;
  const double ahead(ahead_), half = reach / glm::length(line_.direction) + kRounding * std::abs(ahead);
  return ahead + half < line_.first || ahead - half > line_.last;
}

bool LineNear::misses(const dvec3& axis, double reach) const {
  const dvec3 from(from_), across = glm::cross(line_.direction, axis);
  const double size = glm::length(line_.direction) * glm::length(axis);
  return std::abs(glm::dot(from, across)) >
         (reach * kMore + slack_) * glm::length(across) + kRounding * size * glm::length(from);
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
