#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/primitives/disc.h"

namespace kdray::primitives {

namespace {

// The sign of a product of vectors; 0 where rounding may have made it.
int sure_sign(const dvec3& a, const dvec3& b) {
  const double product = glm::dot(a, b), size = glm::dot(glm::abs(a), glm::abs(b));
  if (std::abs(product) <= 8 * std::numeric_limits<double>::epsilon() * size) return 0;
  return product > 0 ? 1 : -1;
}

}  // namespace

dvec3 place_on(const DiscGeometry& d, double share, const dvec3& direction) {
  const dvec3 across = glm::cross(dvec3(d.normal), direction);
  const double length = glm::length(across);
  return dvec3(d.center) + (length > 0 ? share * d.radius / length : 0.0) * across;
}

// Steeply, so that the place in the plane is off by no more than 16 margins.
std::optional<double> sure_target(const Line& line, const DiscGeometry& d, double margin) {
  const dvec3 n(d.normal), way = dvec3(d.center) - line.origin;
  const double facing = glm::dot(n, line.direction);
  if (std::abs(facing) < 0x1p-4 * glm::length(n) * glm::length(line.direction)) return {};
  const double t = glm::dot(n, way) / facing;
  if (!(glm::length(t * line.direction - way) < d.radius - 16 * margin)) return {};
  return t;
}

// A ray that has left a disc meets it only where it was sent towards it.
bool meets_again(const Line& line, const DiscGeometry& d, double, const dvec3&) {
  const dvec3 n(d.normal);
  const int side = sure_sign(n, line.origin - dvec3(d.center)), way = sure_sign(n, line.direction);
  return side * way >= 0;
}

Crossings crossings(const Line& line, const layout::Disc& d) {
  const dvec3 n(d.normal[0], d.normal[1], d.normal[2]);
  const dvec3 way = dvec3(d.center[0], d.center[1], d.center[2]) - line.origin;
  Crossings found;
  if (sure_sign(n, line.direction) == 0) return found;
  const double t = glm::dot(n, way) / glm::dot(n, line.direction),
               away = glm::length(t * line.direction - way);
  if (away <= d.radius) found.add(t, away / d.radius);
  return found;
}

double distance_to(const layout::Disc& d, const dvec3& point) {
  const dvec3 n = glm::normalize(dvec3(d.normal[0], d.normal[1], d.normal[2]));
  const dvec3 from = point - dvec3(d.center[0], d.center[1], d.center[2]);
  const double above = glm::dot(from, n), beyond = glm::length(from - above * n) - d.radius;
  return std::hypot(above, std::max(beyond, 0.0));
}

}  // namespace kdray::primitives
