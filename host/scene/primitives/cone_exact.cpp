#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/primitives/cone.h"

namespace kdray::primitives {

namespace {

// The cone about its axis: radius(s) = base_radius + slope*s at the distance s from the base.
struct Axis {
  dvec3 base, unit;
  double base_radius, slope, height;
};
Axis axis_of(const ConeGeometry& cone) {
  const dvec3 along = dvec3(cone.apex) - dvec3(cone.base);
  const double height = glm::length(along);
  return {dvec3(cone.base), along / height, cone.base_radius,
          (static_cast<double>(cone.apex_radius) - cone.base_radius) / height, height};
}

}  // namespace

dvec3 place_on(const ConeGeometry& c, double share, const dvec3& direction) {
  const double radius = glm::mix(double{c.base_radius}, double{c.apex_radius}, share);
  const dvec3 axis = glm::normalize(dvec3(c.apex) - dvec3(c.base));
  const dvec3 across = glm::cross(axis, direction);
  const double length = glm::length(across);
  return glm::mix(dvec3(c.base), dvec3(c.apex), share) + (length > 0 ? radius / length : 0.0) * across;
}

// Where a line meets a cone is not known so well that its place would be certain.
std::optional<double> sure_target(const Line&, const ConeGeometry&, double) {
  return {};
}

Quadratic along(const Line& line, const ConeGeometry& cone) {
  const Axis axis = axis_of(cone);
  const dvec3 from = line.origin - axis.base;
  const double s = glm::dot(from, axis.unit), ds = glm::dot(line.direction, axis.unit);
  const dvec3 across = from - s * axis.unit, moving = line.direction - ds * axis.unit;
  const double radius = axis.base_radius + axis.slope * s, growing = axis.slope * ds,
               far = glm::length(across);
  return {glm::dot(moving, moving) - growing * growing, glm::dot(across, moving) - radius * growing,
          (far - radius) * (far + radius)};
}

dvec3 outward(const dvec3& point, const ConeGeometry& cone) {
  const Axis axis = axis_of(cone);
  const dvec3 from = point - axis.base;
  const double s = glm::dot(from, axis.unit);
  return (from - s * axis.unit) - axis.slope * (axis.base_radius + axis.slope * s) * axis.unit;
}

bool meets_again(const Line& line, const ConeGeometry& c, double t, const dvec3& side) {
  return hits_again(along(line, c), t, glm::dot(side, outward(line.origin, c)) > 0);
}

// About the place of the line that is nearest to the middle of the axis, so that no term is larger than the
// cone makes it. (0 <= s <= height keeps the other nappe out too: its radius is negative.)
Crossings crossings(const Line& line, const layout::Cone& c) {
  const dvec3 unit(c.axis[0], c.axis[1], c.axis[2]);
  const dvec3 from = line.origin - dvec3(c.base[0], c.base[1], c.base[2]);
  const double height = c.height, slope = c.slope;
  const double middle =
      -glm::dot(from - 0.5 * height * unit, line.direction) / glm::dot(line.direction, line.direction);
  const dvec3 g = from + middle * line.direction;
  const double s = glm::dot(g, unit), ds = glm::dot(line.direction, unit);
  const dvec3 across = g - s * unit, moving = line.direction - ds * unit;
  const double radius = c.base_radius + slope * s, growing = slope * ds;
  const double length = glm::length(moving), far = glm::length(across);
  const double a = (length - growing) * (length + growing), b = glm::dot(across, moving) - radius * growing,
               q = (far - radius) * (far + radius);
  Crossings found;
  const double root = std::sqrt(b * b - a * q);
  if (!(root > 0)) return found;
  const double sum = -(b + std::copysign(root, b));
  double roots[2] = {q / sum, sum / a};
  if (roots[0] > roots[1]) std::swap(roots[0], roots[1]);
  for (const double t : roots) {
    const double at = s + t * ds;
    if (at >= 0 && at <= height) found.add(middle + t, at / height);
  }
  return found;
}

// In the half-plane of the point, where the surface is a line from the base to the apex.
double distance_to(const layout::Cone& c, const dvec3& point) {
  const dvec3 unit(c.axis[0], c.axis[1], c.axis[2]);
  const dvec3 from = point - dvec3(c.base[0], c.base[1], c.base[2]);
  const double s = glm::dot(from, unit), out = glm::length(from - s * unit) - c.base_radius;
  const double slope = c.slope,
               along = std::clamp((s + slope * out) / (1 + slope * slope), 0.0, double{c.height});
  return std::hypot(s - along, out - slope * along);
}

}  // namespace kdray::primitives
