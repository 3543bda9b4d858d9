#include "verify/exact_hits.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kdray::verify {

std::optional<double> sure_hit(const Line& line, const dvec3& a, const dvec3& b, const dvec3& c,
                               double margin) {
  const dvec3 corner[3] = {a - line.origin, b - line.origin, c - line.origin};
  double weight[3], sum = 0;
  for (int k = 0; k < 3; ++k) {
    const dvec3 p = corner[(k + 1) % 3], q = corner[(k + 2) % 3];
    weight[k] = glm::dot(line.direction, glm::cross(p, q));
    // |weight| / |d x edge| is the distance of the two lines.
    if (!(std::abs(weight[k]) > margin * glm::length(glm::cross(line.direction, q - p)))) return {};
    if (weight[k] * weight[0] < 0) return {};
    sum += weight[k];
  }
  const dvec3 at = (weight[0] * corner[0] + weight[1] * corner[1] + weight[2] * corner[2]) / sum;
  return glm::dot(at, line.direction) / glm::dot(line.direction, line.direction);
}

std::optional<double> sure_hit(const Line& line, const scene::SphereGeometry& sphere, double margin) {
  const dvec3 way = dvec3(sphere.center) - line.origin;
  const double length2 = glm::dot(line.direction, line.direction);
  const double nearest = glm::dot(way, line.direction) / length2;
  const double distance = glm::length(way - nearest * line.direction), radius = sphere.radius;
  if (!(distance < radius - margin)) return {};
  const double half = std::sqrt((radius - distance) * (radius + distance) / length2);
  if (nearest - half > 0) return nearest - half;
  return nearest + half;
}

int side_of_plane(const Line& line, const dvec3& a, const dvec3& b, const dvec3& c) {
  const dvec3 n = glm::cross(b - a, c - a), way = a - line.origin;
  const double away = glm::dot(n, way), along = glm::dot(n, line.direction);
  // The edges' and the products' roundings, as sums of absolute values.
  const dvec3 e = glm::abs(b - a), f = glm::abs(c - a);
  const dvec3 size(e.y * f.z + e.z * f.y, e.z * f.x + e.x * f.z, e.x * f.y + e.y * f.x);
  constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
  if (std::abs(away) <= kRounding * glm::dot(size, glm::abs(way))) return 0;
  if (std::abs(along) <= kRounding * glm::dot(size, glm::abs(line.direction))) return 0;
  return (away > 0) == (along > 0) ? 1 : -1;
}

Quadratic along(const Line& line, const scene::SphereGeometry& sphere) {
  const dvec3 out = line.origin - dvec3(sphere.center);
  const double far = glm::length(out), radius = sphere.radius;
  return {glm::dot(line.direction, line.direction), glm::dot(out, line.direction),
          (far - radius) * (far + radius)};
}

namespace {

// The cone about its axis: radius(s) = base_radius + slope*s at the distance s from the base.
struct Axis {
  dvec3 base, unit;
  double base_radius, slope, height;
};
Axis axis_of(const scene::ConeGeometry& cone) {
  const dvec3 along = dvec3(cone.apex) - dvec3(cone.base);
  const double height = glm::length(along);
  return {dvec3(cone.base), along / height, cone.base_radius,
          (static_cast<double>(cone.apex_radius) - cone.base_radius) / height, height};
}

}  // namespace

Quadratic along(const Line& line, const scene::ConeGeometry& cone) {
  const Axis axis = axis_of(cone);
  const dvec3 from = line.origin - axis.base;
  const double s = glm::dot(from, axis.unit), ds = glm::dot(line.direction, axis.unit);
  const dvec3 across = from - s * axis.unit, moving = line.direction - ds * axis.unit;
  const double radius = axis.base_radius + axis.slope * s, growing = axis.slope * ds,
               far = glm::length(across);
  return {glm::dot(moving, moving) - growing * growing, glm::dot(across, moving) - radius * growing,
          (far - radius) * (far + radius)};
}

dvec3 outward(const dvec3& point, const scene::SphereGeometry& sphere) {
  return point - dvec3(sphere.center);
}
dvec3 outward(const dvec3& point, const scene::ConeGeometry& cone) {
  const Axis axis = axis_of(cone);
  const dvec3 from = point - axis.base;
  const double s = glm::dot(from, axis.unit);
  return (from - s * axis.unit) - axis.slope * (axis.base_radius + axis.slope * s) * axis.unit;
}

bool hits_again(const Quadratic& q, double t, bool outside) {
  if (!(q.a > 0)) return false;
  if (outside) return q.c < 0 || q.b > 0;
  if (q.c > 0) return true;
  const double root = std::sqrt(std::max(0.0, q.b * q.b - q.a * q.c));
  const double exit = q.b > 0 ? -q.c / (q.b + root) : (root - q.b) / q.a;
  return t < 0.5 * exit;
}

}  // namespace kdray::verify
