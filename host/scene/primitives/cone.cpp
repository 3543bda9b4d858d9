#include "scene/primitives/cone.h"

#include <cmath>

#include "scene/primitives/box_around.h"
#include "scene/primitives/pack.h"

namespace kdray::primitives {

const char* fault_of(const Cone& c) {
  if (!kdray::is_finite(c.base) || !kdray::is_finite(c.apex)) return "an end of the cone is not finite";
  if (c.base == c.apex) return "base and apex are the same point";
  const auto good = [](double radius) { return std::isfinite(radius) && radius >= 0; };
  if (!good(c.base_radius) || !good(c.apex_radius)) return "a radius of the cone is not finite, or below 0";
  if (c.base_radius + c.apex_radius == 0) return "both radii are 0";
  return nullptr;
}

DBox bounds_of(const Cone& c) {
  const dvec3 reach = disc_reach(c.apex - c.base);
  DBox box{c.base - c.base_radius * reach, c.base + c.base_radius * reach};
  box.grow({c.apex - c.apex_radius * reach, c.apex + c.apex_radius * reach});
  return box;
}

dvec3 middle_of(const Cone& c) {
  return 0.5 * (c.base + c.apex);
}

void transform(const Similarity& m, Cone& c) {
  c.base = m.point(c.base);
  c.apex = m.point(c.apex);
  c.base_radius *= m.factor;
  c.apex_radius *= m.factor;
}

ConeGeometry geometry_of(const Cone& c, const LocalSpace& space, std::uint32_t source) {
  return {vec3(space.local(c.base)), vec3(space.local(c.apex)),
          static_cast<float>(space.local_length(c.base_radius)),
          static_cast<float>(space.local_length(c.apex_radius)), source};
}

bool has_area(const ConeGeometry& c) {
  return c.base != c.apex && (c.base_radius > 0 || c.apex_radius > 0);
}

Box bounds_of(const ConeGeometry& c) {
  // The hull of its two circles. 2^-48 covers the dozen roundings of disc_reach and of its product with the
  // radius.
  const dvec3 reach = disc_reach(dvec3(c.apex) - dvec3(c.base)) * (1 + 0x1p-48);
  Box box = box_around(c.base, reach * static_cast<double>(c.base_radius));
  box.grow(box_around(c.apex, reach * static_cast<double>(c.apex_radius)));
  return box;
}

layout::Cone pack(const ConeGeometry& g) {
  layout::Cone c{};
  const dvec3 axis = dvec3(g.apex) - dvec3(g.base);
  const double height = glm::length(axis);
  set(c.base, g.base);
  set(c.axis, vec3(axis / height));
  c.base_radius = g.base_radius;
  c.height = static_cast<float>(height);
  c.slope = static_cast<float>((double(g.apex_radius) - double(g.base_radius)) / height);
  return c;
}

Box bounds_of(const layout::Cone& c) {
  const vec3 base(c.base[0], c.base[1], c.base[2]), axis(c.axis[0], c.axis[1], c.axis[2]);
  // A circle across the axis reaches this far along each coordinate, for a radius of 1; the axis is of unit
  // length but for rounding.
  const vec3 across = glm::sqrt(glm::max(vec3(1e-5f), vec3(1) - axis * axis));
  Box box = wide_box_around(base, c.base_radius * across);
  const float apex_radius = c.base_radius + c.slope * c.height + 1e-6f * (c.base_radius + c.height);
  box.grow(wide_box_around(base + c.height * axis, apex_radius * across + vec3(1e-6f * c.height)));
  return box;
}

std::array<float, KDRAY_CONE_ROWS - 1> rows_of(const layout::Cone& c) {
  return {c.base[0], c.base[1], c.base[2], c.axis[0], c.axis[1], c.axis[2], c.base_radius, c.height, c.slope};
}

// The radius grows by `slope` along the axis, so the normal leans back by as much.
dvec3 normal_at(const layout::Cone& c, const dvec3& point) {
  const dvec3 axis(c.axis[0], c.axis[1], c.axis[2]);
  const dvec3 from = point - dvec3(c.base[0], c.base[1], c.base[2]);
  const dvec3 out = from - glm::dot(from, axis) * axis;
  if (out == dvec3(0)) return c.slope > 0 ? -axis : axis;  // at the tip
  return glm::normalize(safe_normalize(out) - static_cast<double>(c.slope) * axis);
}

}  // namespace kdray::primitives
