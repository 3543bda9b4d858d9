#include "scene/primitives/torus.h"

#include <cmath>

#include "scene/primitives/box_around.h"
#include "scene/primitives/pack.h"

namespace kdray::primitives {

const char* fault_of(const Torus& t) {
  if (!kdray::is_finite(t.center)) return "the center of the torus is not finite";
  if (!kdray::is_finite(t.axis) || t.axis == dvec3(0)) return "a torus needs an axis with a direction";
  if (!std::isfinite(t.major_radius) || !std::isfinite(t.minor_radius) || !(t.minor_radius > 0))
    return "a torus needs finite radii above 0";
  if (!(t.minor_radius < t.major_radius))
    return "the minor_radius of a torus must be less than its major_radius";
  if (t.major_radius > kThinnestTorus * t.minor_radius)
    return "the major_radius of a torus must be at most 4096 times its minor_radius";
  return nullptr;
}

DBox bounds_of(const Torus& t) {
  const dvec3 reach = t.major_radius * disc_reach(t.axis) + t.minor_radius;
  return {t.center - reach, t.center + reach};
}

dvec3 middle_of(const Torus& t) {
  return t.center;
}

void transform(const Similarity& m, Torus& t) {
  t.center = m.point(t.center);
  t.axis = m.direction(t.axis);
  t.major_radius *= m.factor;
  t.minor_radius *= m.factor;
}

TorusGeometry geometry_of(const Torus& t, const LocalSpace& space, std::uint32_t source) {
  return {vec3(space.local(t.center)), vec3(safe_normalize(t.axis)),
          static_cast<float>(space.local_length(t.major_radius)),
          static_cast<float>(space.local_length(t.minor_radius)), source};
}

bool has_area(const TorusGeometry& t) {
  return t.minor_radius > 0;
}

Box bounds_of(const TorusGeometry& t) {
  // 2^-48 covers the dozen roundings of disc_reach, of its product and of the sum.
  const dvec3 circle = disc_reach(dvec3(t.axis)) * static_cast<double>(t.major_radius);
  return box_around(t.center, (circle + static_cast<double>(t.minor_radius)) * (1 + 0x1p-48));
}

layout::Torus pack(const TorusGeometry& g) {
  layout::Torus t{};
  set(t.center, g.center);
  t.major_radius = g.major_radius;
  set(t.axis, g.axis);
  t.minor_radius = g.minor_radius;
  return t;
}

Box bounds_of(const layout::Torus& t) {
  const vec3 axis(t.axis[0], t.axis[1], t.axis[2]);
  // The axis is of unit length but for rounding.
  const vec3 across = glm::sqrt(glm::max(vec3(1e-5f), vec3(1) - axis * axis));
  return wide_box_around({t.center[0], t.center[1], t.center[2]}, t.major_radius * across + t.minor_radius);
}

std::array<float, KDRAY_TORUS_ROWS - 1> rows_of(const layout::Torus& t) {
  return {t.center[0], t.center[1], t.center[2],    t.axis[0],
          t.axis[1],   t.axis[2],   t.major_radius, t.minor_radius};
}

// Away from the nearest place of the circle; in the tube's middle, where there is none, along the axis.
dvec3 normal_at(const layout::Torus& t, const dvec3& point) {
  const dvec3 axis = glm::normalize(dvec3(t.axis[0], t.axis[1], t.axis[2]));
  const dvec3 from = point - dvec3(t.center[0], t.center[1], t.center[2]);
  const double along = glm::dot(from, axis);
  const dvec3 across = from - along * axis;
  const double away = glm::length(across), beyond = away - static_cast<double>(t.major_radius);
  const dvec3 out = away > 0 ? across / away : dvec3(0), normal = beyond * out + along * axis;
  return normal == dvec3(0) ? axis : glm::normalize(normal);
}

}  // namespace kdray::primitives
