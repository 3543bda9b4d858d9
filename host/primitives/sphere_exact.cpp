#include <algorithm>
#include <cmath>

#include "primitives/sphere.h"

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

}  // namespace kdray::primitives
