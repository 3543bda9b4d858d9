#include "scene/primitives/sphere.h"

#include <cmath>

#include "scene/primitives/box_around.h"
#include "scene/primitives/pack.h"

namespace kdray::primitives {

const char* fault_of(const Sphere& s) {
  const bool good = kdray::is_finite(s.center) && std::isfinite(s.radius) && s.radius > 0;
  return good ? nullptr : "a sphere needs a finite center and a radius above 0";
}

DBox bounds_of(const Sphere& s) {
  return {s.center - s.radius, s.center + s.radius};
}

dvec3 middle_of(const Sphere& s) {
  return s.center;
}

void transform(const Similarity& m, Sphere& s) {
  s.center = m.point(s.center);
  s.radius *= m.factor;
}

SphereGeometry geometry_of(const Sphere& s, const LocalSpace& space, std::uint32_t source) {
  return {vec3(space.local(s.center)), static_cast<float>(space.local_length(s.radius)), source};
}

bool has_area(const SphereGeometry& s) {
  return s.radius > 0;
}

Box bounds_of(const SphereGeometry& s) {
  return box_around(s.center, dvec3(s.radius));
}

layout::Sphere pack(const SphereGeometry& g) {
  layout::Sphere s{};
  set(s.center, g.center);
  s.radius = g.radius;
  return s;
}

Box bounds_of(const layout::Sphere& s) {
  return wide_box_around({s.center[0], s.center[1], s.center[2]}, vec3(s.radius));
}

std::array<float, KDRAY_SPHERE_ROWS - 1> rows_of(const layout::Sphere& s) {
  return {s.center[0], s.center[1], s.center[2], s.radius};
}

dvec3 normal_at(const layout::Sphere& s, const dvec3& point) {
  return safe_normalize(point - dvec3(s.center[0], s.center[1], s.center[2]));
}

}  // namespace kdray::primitives
