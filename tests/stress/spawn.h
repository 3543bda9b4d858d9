// What    The rays that kdray's shading spawns at given hits: its own kernel code (shade/surface.clh,
//         shade/secondary.clh) in a kernel of the test's, which writes them out.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/prepare/prepared.h"
#include "device/opencl/context.h"
#include "device/opencl/kernel.h"
#include "engine/wavefront/scene_buffers.h"
#include "kdray/kdray.h"

// The arguments of the kernel in spawn.cpp, whose source has this list as well.
#define SPAWN_ARGUMENTS(F, X) \
  F(VALUE, u32, n)            \
  KDRAY_SURFACE_ARRAYS(X)     \
  X(IN, ToSpawn, hits)        \
  X(OUT, Spawned, spawned)
namespace kdray::kernels {
KDRAY_DECLARE_KERNEL(Spawn, "spawn.cl", spawn, SPAWN_ARGUMENTS)
}  // namespace kdray::kernels

namespace kdray::stress {

struct ToSpawn {
  float origin[3], direction[3];  // of the ray, unit length
  float t;
  std::uint32_t ref;  // what it hit (layout/tree.layout.h), or KDRAY_REF_MISS
  float u, v;
  float light[3];  // its position
  float index;     // of refraction
};
static_assert(sizeof(ToSpawn) == 56);

inline constexpr std::uint32_t kFromInside = 1, kRefracts = 2, kLit = 4;

struct Spawned {
  float above[3];  // where the reflected ray and the shadow ray start
  float below[3];  // where the refracted ray starts
  float reflected[3], refracted[3], to_light[3];
  float point[3], point_error[3], normal[3];
  std::uint32_t flags;  // kFromInside ...
};
static_assert(sizeof(Spawned) == 100);

class Spawner {
 public:
  explicit Spawner(const prepare::Prepared& scene);
  std::vector<Spawned> spawn(const std::vector<ToSpawn>& hits);

 private:
  device::Context context_;
  wavefront::SceneBuffers scene_;
  device::Kernel<kernels::Spawn> spawn_;
};

}  // namespace kdray::stress
