#include "query/surface.h"

#include "primitives/shapes.h"

namespace kdray::query {

namespace {

template <class Visit>
auto with_primitive(const flatten::FlatScene& scene, std::uint32_t ref, const Visit& visit) {
  return primitives::with_kind(ref >> KDRAY_REF_KIND_SHIFT, [&](auto kind) {
    return visit(decltype(kind)::of(scene)[ref & KDRAY_REF_INDEX_MASK]);
  });
}

dvec3 corner(const layout::Triangle& t, int i) {
  return {t.v[i][0], t.v[i][1], t.v[i][2]};
}

// In double, which floats' differences and products leave with next to no rounding, and whose range their
// squares don't leave.
dvec3 normal_of(const layout::Triangle& t) {
  const dvec3 a = corner(t, 0), n = glm::cross(corner(t, 1) - a, corner(t, 2) - a);
  return n == dvec3(0) ? n : glm::normalize(n);
}

}  // namespace

std::uint32_t number_of(const flatten::FlatScene& scene, std::uint32_t ref) {
  return with_primitive(scene, ref, [](const auto& primitive) { return primitive.number; });
}

dvec3 normal_at(const flatten::FlatScene& scene, std::uint32_t ref, const dvec3& point) {
  return with_primitive(scene, ref, [&](const auto& primitive) {
    if constexpr (requires { normal_of(primitive); })
      return normal_of(primitive);
    else
      return primitives::normal_at(primitive, point);
  });
}

}  // namespace kdray::query
