// What    What the kernels that trace rays from outside are given of a scene.
#pragma once

#include "device/opencl.h"
#include "math/box.h"
#include "math/local_space.h"

namespace kdray::query {

inline cl_float4 float4(const vec3& v, float w = 0) {
  return cl_float4{{v.x, v.y, v.z, w}};
}

// The centre and the scale.
inline cl_float4 float4(const LocalSpace& space) {
  return float4(vec3(space.center), static_cast<float>(space.scale));
}

// The largest coordinate of anything.
inline float world_max(const Box& bounds) {
  if (bounds.empty()) return 0;
  const vec3 m = glm::max(glm::abs(bounds.lo), glm::abs(bounds.hi));
  return std::max({m.x, m.y, m.z});
}

}  // namespace kdray::query
