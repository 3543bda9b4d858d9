#include "bench/workload/surfaces.h"

namespace kdray::bench {

namespace {

// Of any length. A kind that lacks one does not compile.
dvec3 normal_of(const scene::Scene& scene, const scene::Triangle& t, const dvec3&) {
  const dvec3 a = scene.vertices[t.vertex[0]];
  return glm::cross(scene.vertices[t.vertex[1]] - a, scene.vertices[t.vertex[2]] - a);
}

dvec3 normal_of(const scene::Scene&, const scene::Sphere& s, const dvec3& point) {
  return point - s.center;
}

// Across the slanted side: away from the axis, and back along it where the cone widens.
dvec3 normal_of(const scene::Scene&, const scene::Cone& c, const dvec3& point) {
  const double height = glm::length(c.apex - c.base);
  const dvec3 axis = (c.apex - c.base) / height;
  const dvec3 radial = (point - c.base) - axis * glm::dot(point - c.base, axis);
  const double distance = glm::length(radial);
  if (!(distance > 0)) return axis;
  return radial / distance - axis * ((c.apex_radius - c.base_radius) / height);
}

dvec3 normal_of(const scene::Scene&, const scene::Disc& d, const dvec3&) {
  return d.normal;
}

// Away from the nearest place of its circle.
dvec3 normal_of(const scene::Scene&, const scene::Torus& t, const dvec3& point) {
  const dvec3 axis = glm::normalize(t.axis), from = point - t.center;
  const dvec3 across = from - glm::dot(from, axis) * axis;
  return from - across * (t.major_radius / glm::length(across));
}

}  // namespace

Surfaces::Surfaces(const scene::Scene& scene) : scene_(scene), entries_(scene.primitive_count()) {
  primitives::for_each_kind([&](auto kind) {
    const auto& all = decltype(kind)::of(scene);
    for (std::uint32_t i = 0; i < all.size(); ++i) entries_[all[i].number] = {kind.kNumber, i};
  });
}

dvec3 Surfaces::normal(std::uint32_t number, const dvec3& point) const {
  const Entry& entry = entries_.at(number);
  return glm::normalize(primitives::with_kind(entry.kind, [&](auto kind) {
    return normal_of(scene_, decltype(kind)::of(scene_)[entry.index], point);
  }));
}

}  // namespace kdray::bench
