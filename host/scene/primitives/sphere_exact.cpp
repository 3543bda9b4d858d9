#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "scene/primitives/sphere.h"

namespace kdray::primitives {

dvec3 place_on(const SphereGeometry& s, double share, const dvec3& direction) {
  return dvec3(s.center) + share * s.radius * direction;
}

std::optional<double> sure_hit(const Line& line, const SphereGeometry& s, double margin) {
  const dvec3 way = dvec3(s.center) - line.origin;
  const double length2 = glm::dot(line.direction, line.direction);
  const double nearest = glm::dot(way, line.direction) / length2;
  const double distance = glm::length(way - nearest * line.direction), radius = s.radius;
  if (!(distance < radius - margin)) return {};
  const double half = std::sqrt((radius - distance) * (radius + distance) / length2);
  if (nearest - half > 0) return nearest - half;
  return nearest + half;
}

// Well inside of the outline, near which the distance is off by more than the surface is.
std::optional<double> sure_target(const Line& line, const SphereGeometry& s, double margin) {
  return sure_hit(line, s, margin + 0.01 * s.radius);
}

Quadratic along(const Line& line, const SphereGeometry& s) {
  const dvec3 out = line.origin - dvec3(s.center);
  const double far = glm::length(out), radius = s.radius;
  return {glm::dot(line.direction, line.direction), glm::dot(out, line.direction),
          (far - radius) * (far + radius)};
}

dvec3 outward(const dvec3& point, const SphereGeometry& s) {
  return point - dvec3(s.center);
}

bool meets_again(const Line& line, const SphereGeometry& s, double t, const dvec3& side) {
  return hits_again(along(line, s), t, glm::dot(side, outward(line.origin, s)) > 0);
}

namespace {

std::pair<double, double> two_sum(double a, double b) {
  const double sum = a + b, back = sum - a;
  return {sum, (a - (sum - back)) + (b - back)};
}

// The square of the distance from the centre less that of the radius, to 2^-100 of the larger: a point as
// near to the surface as doubles can be is on the side that it is on.
double power_of(const dvec3& point, const layout::Sphere& s) {
  double sum = -double{s.radius} * s.radius, rest = 0;
  for (int k = 0; k < 3; ++k) {
    const auto [high, low] = two_sum(point[k], -double{s.center[k]});
    const double square = high * high;
    const auto [added, lost] = two_sum(sum, square);
    sum = added;
    rest += lost + std::fma(high, high, -square) + 2 * high * low;
  }
  return sum + rest;
}

}  // namespace

// The root that is nearer to the origin is found from the other: it has the sign of the origin's side.
Crossings crossings(const Line& line, const layout::Sphere& s) {
  const dvec3 way = dvec3(s.center[0], s.center[1], s.center[2]) - line.origin;
  const double length2 = glm::dot(line.direction, line.direction), radius = s.radius;
  const double nearest = glm::dot(way, line.direction) / length2, power = power_of(line.origin, s);
  const double distance = glm::length(way - nearest * line.direction);
  Crossings found;
  if (power > 0 && !(distance < radius)) return found;
  const double half = std::sqrt(std::max(0.0, (radius - distance) * (radius + distance)) / length2);
  const double far = nearest + std::copysign(half, nearest), near = far == 0 ? 0 : power / (length2 * far);
  double t0 = std::min(near, far), t1 = std::max(near, far);
  constexpr double kLeast = std::numeric_limits<double>::min();
  if (power < 0) t0 = std::min(t0, -kLeast), t1 = std::max(t1, kLeast);
  if (t0 == t1) return found;  // it is touched
  found.add(t0);
  found.add(t1);
  return found;
}

double distance_to(const layout::Sphere& s, const dvec3& point) {
  return std::abs(glm::distance(point, dvec3(s.center[0], s.center[1], s.center[2])) - s.radius);
}

}  // namespace kdray::primitives
