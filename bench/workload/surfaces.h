// What    What a scene's primitive is at a point of it, found by the primitive's number.
#pragma once

#include <cstdint>
#include <vector>

#include "base/local_space.h"
#include "scene/model/scene.h"
#include "scene/primitives/shapes.h"

namespace kdray::bench {

class Surfaces {
  struct Entry {
    std::uint32_t kind, index;
  };

  template <class Visit>
  auto visit(std::uint32_t number, const Visit& visit_primitive) const {
    const Entry& entry = entries_.at(number);
    return primitives::with_kind(
        entry.kind, [&](auto kind) { return visit_primitive(decltype(kind)::of(scene_)[entry.index]); });
  }

  // Of any length.
  dvec3 normal_of(const scene::Triangle& t, const dvec3&) const {
    const dvec3 a = scene_.vertices[t.vertex[0]];
    return glm::cross(scene_.vertices[t.vertex[1]] - a, scene_.vertices[t.vertex[2]] - a);
  }
  // About the shape's own middle, where floats lose nothing of where it is.
  template <class Shape>
  dvec3 normal_of(const Shape& shape, const dvec3& point) const {
    const LocalSpace about{middle_of(shape)};
    return primitives::normal_at(pack(primitives::geometry_of(shape, about, 0)), about.local(point));
  }

 public:
  // The scene has to outlive this.
  explicit Surfaces(const scene::Scene& scene) : scene_(scene), entries_(scene.primitive_count()) {
    primitives::for_each_kind([&](auto kind) {
      const auto& all = decltype(kind)::of(scene);
      for (std::uint32_t i = 0; i < all.size(); ++i) entries_[all[i].number] = {kind.kNumber, i};
    });
  }

  // Unit length, of the surface itself (not interpolated); which side it points to is the primitive's affair.
  dvec3 normal(std::uint32_t number, const dvec3& point) const {
    return glm::normalize(visit(number, [&](const auto& p) { return normal_of(p, point); }));
  }
  const scene::Material& material(std::uint32_t number) const {
    return scene_.materials[visit(number, [](const auto& p) { return p.material; })];
  }

 private:
  const scene::Scene& scene_;
  std::vector<Entry> entries_;  // by number
};

}  // namespace kdray::bench
