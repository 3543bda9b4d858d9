#include "apps/verify/exact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/model/predicates.h"

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

namespace {

using scene::dvec2;

dvec2 across_x(const dvec3& p) {
  return {p.y, p.z};
}

enum class Crossing { none, one, unsure };

// Returns whether the ray from p along +x crosses the triangle.
Crossing crossing(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
  const int ab = scene::orient_sign(across_x(a), across_x(b), across_x(p));
  const int bc = scene::orient_sign(across_x(b), across_x(c), across_x(p));
  const int ca = scene::orient_sign(across_x(c), across_x(a), across_x(p));
  if (ab * bc < 0 || bc * ca < 0 || ca * ab < 0) return Crossing::none;
  if (ab == 0 || bc == 0 || ca == 0) return Crossing::unsure;
  // The sign of this volume tells on which side of the plane p lies. The triangle's winding, seen along x,
  // tells which side lies ahead of the ray.
  const dvec3 u = a - p, v = b - p, w = c - p;
  const dvec3 m = glm::cross(v, w);
  const double volume = glm::dot(u, m);
  const dvec3 size = glm::abs(dvec3(v.y, v.z, v.x)) * glm::abs(dvec3(w.z, w.x, w.y)) +
                     glm::abs(dvec3(v.z, v.x, v.y)) * glm::abs(dvec3(w.y, w.z, w.x));
  const double bound = 16 * std::numeric_limits<double>::epsilon() * glm::dot(glm::abs(u), size);
  if (std::abs(volume) <= bound) return Crossing::unsure;
  return (volume > 0) == (ab > 0) ? Crossing::one : Crossing::none;
}

// Returns the distance of p from the line through a and b, which differ: corners of a zero-area triangle.
double distance_from_line(const dvec3& p, const dvec3& a, const dvec3& b) {
  return glm::length(glm::cross(b - a, p - a)) / glm::length(b - a);
}

}  // namespace

bool Insides::near(const dvec3& p, std::uint32_t component, double clearance) const {
  bool near = false;
  boxes_.touching({p - clearance, p + clearance}, [&](std::uint32_t face) {
    if (topology_.component_of[face] != component) return true;
    const dvec3 a(mesh_.corner(face, 0)), n = mesh_.normal(face);
    near = mesh_.zero_area[face] != 0 ? !(distance_from_line(p, a, dvec3(mesh_.corner(face, 1))) > clearance)
                                      : !(std::abs(glm::dot(n, p - a)) > clearance * glm::length(n));
    return !near;
  });
  return near;
}

Side Insides::side_of(const dvec3& p, std::uint32_t component, double clearance) const {
  if (near(p, component, clearance)) return Side::unsure;
  bool odd = false, unsure = false;
  const dvec3 far(std::numeric_limits<double>::infinity(), p.y, p.z);
  boxes_.touching({p, far}, [&](std::uint32_t face) {
    if (topology_.component_of[face] != component) return true;
    switch (crossing(p, dvec3(mesh_.corner(face, 0)), dvec3(mesh_.corner(face, 1)),
                     dvec3(mesh_.corner(face, 2)))) {
      case Crossing::one:
        odd = !odd;
        break;
      case Crossing::unsure:
        unsure = true;
        break;
      case Crossing::none:
        break;
    }
    return !unsure;
  });
  if (unsure) return Side::unsure;
  return odd ? Side::inside : Side::outside;
}

}  // namespace kdray::verify
