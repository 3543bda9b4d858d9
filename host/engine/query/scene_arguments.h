// What    The arguments of a query's kernel that tell of the scene: its arrays and its bounds.
#pragma once

#include <algorithm>

#include "engine/query/target.h"

namespace kdray::query {

inline cl_float4 float4(const vec3& v, float w = 0) {
  return cl_float4{{v.x, v.y, v.z, w}};
}

// The centre and the scale.
inline cl_float4 float4(const LocalSpace& space) {
  return float4(vec3(space.center), static_cast<float>(space.scale));
}

// The largest coordinate of a scene, in its own space.
inline float world_max(const Box& bounds) {
  if (bounds.empty()) return 0;
  const vec3 m = glm::max(glm::abs(bounds.lo), glm::abs(bounds.hi));
  return std::max({m.x, m.y, m.z});
}

// Of a kernel that K describes, by whatever holds it.
template <template <class> class Kernel, class K>
void set_scene_arguments(Kernel<K>& kernel, const Target& target) {
  const Box& bounds = target.scene.geometry.bounds;
  target.buffers.set_arguments(kernel);
  KDRAY_SET_WHERE_TAKEN(K, kernel, root_lo, float4(bounds.lo));
  KDRAY_SET_WHERE_TAKEN(K, kernel, root_hi, float4(bounds.hi));
  KDRAY_SET_WHERE_TAKEN(K, kernel, world_max, query::world_max(bounds));
}

}  // namespace kdray::query
