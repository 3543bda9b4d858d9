// What    What is known of the surface at a hit, from the reference that the kernels name it by
//         (tree.layout.h).
// Shape   In the scene's own space, in double.
// Errors  ErrorCode::internal for a kind that there is none of.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "accel/flatten/flatten.h"
#include "accel/prepare/prepared.h"
#include "base/vec.h"
#include "kdray/model.h"
#include "scene/primitives/shapes.h"

namespace kdray::query {

// The primitive's place in file order.
inline std::uint32_t number_of(const flatten::FlatScene& scene, std::uint32_t ref) {
  return primitives::with_kind(ref >> KDRAY_REF_KIND_SHIFT, [&](auto kind) {
    return decltype(kind)::of(scene)[ref & KDRAY_REF_INDEX_MASK].number;
  });
}

// The same of many primitives: without a look where their indices are their numbers already.
class Numbers {
 public:
  explicit Numbers(const prepare::Prepared& scene)
      : scene_(&scene.flat), are_indices_((scene.features & KDRAY_FEATURE_NUMBERS) == 0) {}

  std::uint32_t of(std::uint32_t ref) const {
    return are_indices_ ? ref & KDRAY_REF_INDEX_MASK : number_of(*scene_, ref);
  }
  // For a call of of(ref) that comes soon. (Inlined: g++ leaves out calls of what does nothing but fetch.)
  [[gnu::always_inline]] void fetch(std::uint32_t ref) const {
    if (are_indices_) return;
    primitives::with_kind(ref >> KDRAY_REF_KIND_SHIFT, [&](auto kind) {
      __builtin_prefetch(&decltype(kind)::of(*scene_)[ref & KDRAY_REF_INDEX_MASK].number);
    });
  }

 private:
  const flatten::FlatScene* scene_;
  bool are_indices_;
};

// Of instances by index, or kNoInstance: their places in the scene's list.
inline void name_places(const flatten::FlatScene& scene, std::span<std::uint32_t> instances) {
  for (std::uint32_t& instance : instances)
    if (instance != kNoInstance) instance = scene.instances[instance].number;
}

struct Surface {
  std::uint32_t number;  // the primitive's place in file order
  // Of unit length: of a triangle to the side from which its corners run counterclockwise, of a sphere
  // outward, of a cone away from its axis, of a disc as it was given. 0 for a triangle without area.
  dvec3 normal;
};

// In double, which floats' differences and products leave with next to no rounding, and whose range their
// squares don't leave.
inline dvec3 normal_of(const std::array<dvec3, 3>& t) {
  const dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  return n == dvec3(0) ? n : glm::normalize(n);
}
inline dvec3 normal_of(const layout::Triangle& t) {
  const auto corner = [&](int i) { return dvec3(t.v[i][0], t.v[i][1], t.v[i][2]); };
  return normal_of(std::array{corner(0), corner(1), corner(2)});
}

// `point_of()`, a point on the primitive, is asked for only where the normal depends on it.
template <class PointOf>
Surface surface_at(const flatten::FlatScene& scene, std::uint32_t ref, const PointOf& point_of) {
  return primitives::with_kind(ref >> KDRAY_REF_KIND_SHIFT, [&](auto kind) {
    const auto& primitive = decltype(kind)::of(scene)[ref & KDRAY_REF_INDEX_MASK];
    if constexpr (requires { normal_of(primitive); })
      return Surface{primitive.number, normal_of(primitive)};
    else
      return Surface{primitive.number, primitives::normal_at(primitive, point_of())};
  });
}

// Of a hit in a scene of doubles, in whose own space the point is.
template <class PointOf>
dvec3 normal_in_doubles(const scene::DoubleGeometry& doubles, std::uint32_t ref, const PointOf& point_of) {
  return primitives::with_kind(ref >> KDRAY_REF_KIND_SHIFT, [&](auto kind) {
    const std::uint32_t index = ref & KDRAY_REF_INDEX_MASK;
    if constexpr (decltype(kind)::kIsShape)
      return primitives::normal_at(decltype(kind)::of(doubles)[index], point_of());
    else
      return normal_of(doubles.at(index));
  });
}

// row * v
inline dvec3 by_rows(const float (&rows)[3][3], const dvec3& v) {
  const auto row = [&](int i) { return glm::dot(dvec3(rows[i][0], rows[i][1], rows[i][2]), v); };
  return {row(0), row(1), row(2)};
}

// A point of the scene's space in the instance's mesh's.
inline dvec3 in_mesh(const layout::Instance& instance, const dvec3& p) {
  const dvec3 place(instance.place[0], instance.place[1], instance.place[2]),
      mesh_place(instance.mesh_place[0], instance.mesh_place[1], instance.mesh_place[2]);
  return by_rows(instance.to_mesh, p - place) + mesh_place;
}

// A normal there as it is in the scene: directions across the surface go by the inverse transpose, which
// leaves what is in front of a mirrored instance in front.
inline dvec3 normal_in_scene(const layout::Instance& instance, const dvec3& n) {
  dvec3 moved(0);
  for (int row = 0; row < 3; ++row)
    moved += n[row] * dvec3(instance.to_mesh[row][0], instance.to_mesh[row][1], instance.to_mesh[row][2]);
  return moved == dvec3(0) ? moved : glm::normalize(moved);
}

}  // namespace kdray::query
