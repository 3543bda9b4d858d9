#include "bench/workload/surfaces.h"

namespace kdray::bench {

namespace {

using scene::PrimitiveKind;

dvec3 normal_of(const scene::Scene& scene, const scene::Triangle& t) {
  const dvec3 a = scene.vertices[t.vertex[0]];
  return glm::cross(scene.vertices[t.vertex[1]] - a, scene.vertices[t.vertex[2]] - a);
}

// The normal points across the slanted side: away from the axis, and back along it where the cone widens.
dvec3 normal_of(const scene::Cone& c, const dvec3& point) {
  const double height = glm::length(c.apex - c.base);
  const dvec3 axis = (c.apex - c.base) / height;
  const dvec3 radial = (point - c.base) - axis * glm::dot(point - c.base, axis);
  const double distance = glm::length(radial);
  if (!(distance > 0)) return axis;
  return radial / distance - axis * ((c.apex_radius - c.base_radius) / height);
}

template <class Primitives, class Entry>
void put(std::vector<Entry>& entries, const Primitives& primitives, PrimitiveKind kind) {
  for (std::uint32_t i = 0; i < primitives.size(); ++i) entries[primitives[i].number] = {kind, i};
}

}  // namespace

Surfaces::Surfaces(const scene::Scene& scene) : scene_(scene), entries_(scene.primitive_count()) {
  put(entries_, scene.triangles, PrimitiveKind::triangle);
  put(entries_, scene.spheres, PrimitiveKind::sphere);
  put(entries_, scene.cones, PrimitiveKind::cone);
}

dvec3 Surfaces::normal(std::uint32_t number, const dvec3& point) const {
  const Entry& entry = entries_.at(number);
  switch (entry.kind) {
    case PrimitiveKind::sphere:
      return glm::normalize(point - scene_.spheres[entry.index].center);
    case PrimitiveKind::cone:
      return glm::normalize(normal_of(scene_.cones[entry.index], point));
    default:
      return glm::normalize(normal_of(scene_, scene_.triangles[entry.index]));
  }
}

}  // namespace kdray::bench
