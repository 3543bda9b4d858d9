#include "scene/primitives/disc.h"

#include <cmath>

#include "scene/primitives/box_around.h"
#include "scene/primitives/pack.h"

namespace kdray::primitives {

const char* fault_of(const Disc& d) {
  if (!kdray::is_finite(d.center) || !std::isfinite(d.radius) || !(d.radius > 0))
    return "a disc needs a finite center and a radius above 0";
  const bool has_direction = kdray::is_finite(d.normal) && d.normal != dvec3(0);
  return has_direction ? nullptr : "a disc needs a normal with a direction";
}

DBox bounds_of(const Disc& d) {
  const dvec3 reach = d.radius * disc_reach(d.normal);
  return {d.center - reach, d.center + reach};
}

dvec3 middle_of(const Disc& d) {
  return d.center;
}

void transform(const Similarity& m, Disc& d) {
  d.center = m.point(d.center);
  d.normal = m.direction(d.normal);
  d.radius *= m.factor;
}

DiscGeometry geometry_of(const Disc& d, const LocalSpace& space, std::uint32_t source) {
  return {vec3(space.local(d.center)), vec3(safe_normalize(d.normal)),
          static_cast<float>(space.local_length(d.radius)), source};
}

bool has_area(const DiscGeometry& d) {
  return d.radius > 0;
}

Box bounds_of(const DiscGeometry& d) {
  // 2^-48 covers the dozen roundings of disc_reach and of its product with the radius.
  return box_around(d.center, disc_reach(dvec3(d.normal)) * (static_cast<double>(d.radius) * (1 + 0x1p-48)));
}

layout::Disc pack(const DiscGeometry& g) {
  layout::Disc d{};
  set(d.center, g.center);
  set(d.normal, g.normal);
  d.radius = g.radius;
  return d;
}

Box bounds_of(const layout::Disc& d) {
  const vec3 normal(d.normal[0], d.normal[1], d.normal[2]);
  // The normal is of unit length but for rounding.
  const vec3 across = glm::sqrt(glm::max(vec3(1e-5f), vec3(1) - normal * normal));
  return wide_box_around({d.center[0], d.center[1], d.center[2]}, d.radius * across);
}

std::array<float, KDRAY_DISC_ROWS - 1> rows_of(const layout::Disc& d) {
  return {d.center[0], d.center[1], d.center[2], d.normal[0], d.normal[1], d.normal[2], d.radius};
}

dvec3 normal_at(const layout::Disc& d, const dvec3&) {
  return glm::normalize(dvec3(d.normal[0], d.normal[1], d.normal[2]));
}

}  // namespace kdray::primitives
