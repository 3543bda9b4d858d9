#include "bench/workload/surfaces.h"

#include "base/local_space.h"
#include "scene/primitives/shapes.h"

namespace kdray::bench {

namespace {

// Of any length.
dvec3 normal_of(const scene::Scene& scene, const scene::Triangle& t, const dvec3&) {
  const dvec3 a = scene.vertices[t.vertex[0]];
  return glm::cross(scene.vertices[t.vertex[1]] - a, scene.vertices[t.vertex[2]] - a);
}

// About the shape's own middle, where floats lose nothing of where it is.
template <class Shape>
dvec3 normal_of(const scene::Scene&, const Shape& shape, const dvec3& point) {
  const LocalSpace about{middle_of(shape)};
  return primitives::normal_at(pack(primitives::geometry_of(shape, about, 0)), about.local(point));
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
