#include "stress/spawn.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "device/opencl/opencl_error.h"
#include "device/opencl/simd.h"

namespace kdray::stress {

namespace {

const char* const kSource = R"(
#include "shade/surface.clh"
#include "shade/secondary.clh"
typedef struct ToSpawn { float origin[3], direction[3], t; uint ref; float u, v, light[3], index; } ToSpawn;
typedef struct Spawned {
  float above[3], below[3], reflected[3], refracted[3], to_light[3], point[3], point_error[3], normal[3];
  uint flags;
} Spawned;

#define FOR_LANES for (uint k = 0; k < 16; ++k)
typedef union Lanes { float16 v; float f[16]; uint u[16]; } Lanes;

Real3xN gather3(__global const float* first) {
  Lanes x, y, z;
  FOR_LANES {
    __global const float* p = first + k * (sizeof(ToSpawn) / sizeof(float));
    x.f[k] = p[0], y.f[k] = p[1], z.f[k] = p[2];
  }
  const Real3xN r = {x.v, y.v, z.v};
  return r;
}
float16 gather(__global const float* first) {
  Lanes x;
  FOR_LANES x.f[k] = first[k * (sizeof(ToSpawn) / sizeof(float))];
  return x.v;
}
void scatter3(Real3xN v, __global float* first) {
  Lanes x, y, z;
  x.v = v.x, y.v = v.y, z.v = v.z;
  FOR_LANES {
    __global float* p = first + k * (sizeof(Spawned) / sizeof(float));
    p[0] = x.f[k], p[1] = y.f[k], p[2] = z.f[k];
  }
}

// n: a multiple of sixteen.
#define SPAWN_ARGUMENTS(F, X) \
  F(VALUE, u32, n) KDRAY_SURFACE_ARRAYS(X) X(IN, ToSpawn, hits) X(OUT, Spawned, spawned)
__kernel void spawn(KDRAY_PARAMETERS(SPAWN_ARGUMENTS)) {
  const uint i = 16 * (uint)get_global_id(0);
  if (i >= n) return;
  __global const ToSpawn* in = in_hits + i;
  __global Spawned* out = out_spawned + i;
  const SurfaceArrays arrays = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SURFACE_ARRAYS);
  const Real3xN o = gather3(in->origin), d = gather3(in->direction), light = gather3(in->light);
  const Hits hits = {gather(&in->t), as_uint16(gather((__global const float*)&in->ref)), gather(&in->u),
                     gather(&in->v)};
  const lanes16 hit = hits.ref < KDRAY_REF_INVALID;
  Surface s;
  surfaces_at(&arrays, o, d, &hits, hit, &s);
  // The same as in shade.clh.
  const float16 index = gather(&in->index), eta = s.inside ? index : 1.0f / index;
  Real3xN refracted;
  const lanes16 refracts = refracted_direction(d, s.shading, s.normal, eta, &refracted);
  const Real3xN above = offset_origin(s.point, s.point_error, s.normal);
  const Real3xN light_origin = offset_origin(s.light_end, s.point_error, s.normal);
  const Real3xN way = sub3(light, s.point);
  const lanes16 lit = dot3(s.shading, divide3(way, sqrt(dot3(way, way)))) > 0.0f;
  scatter3(above, out->above);
  scatter3(offset_origin(s.point, s.point_error, negate3(s.normal)), out->below);
  scatter3(reflected_direction(d, s.shading, s.normal), out->reflected);
  scatter3(refracted, out->refracted);
  scatter3(sub3(light, light_origin), out->to_light);
  scatter3(s.point, out->point);
  scatter3(s.point_error, out->point_error);
  scatter3(s.normal, out->normal);
  const uint16 flags = (s.inside ? (uint16)(1u) : (uint16)(0u)) | (refracts ? (uint16)(2u) : (uint16)(0u)) |
                       (lit ? (uint16)(4u) : (uint16)(0u));
  Lanes f;
  f.v = as_float16(flags);
  FOR_LANES out[k].flags = f.u[k];
}
)";

std::string options_for(const device::Context& context, layout::Features features) {
  std::string options = fmt::format("-cl-std=CL1.2 -DKDRAY_FEATURES={:#010x}u {}", features,
                                    device::build_option(context.simd()));
  if (context.rounds_division_correctly()) options += " -cl-fp32-correctly-rounded-divide-sqrt";
  return options;
}

}  // namespace

Spawner::Spawner(const prepare::Prepared& scene)
    : context_("auto", 1),
      scene_(context_, scene.flat, scene.wide),
      spawn_(context_.build_text("spawn.cl", kSource, options_for(context_, scene.features))) {
  scene_.set_arguments(spawn_);
}

std::vector<Spawned> Spawner::spawn(const std::vector<ToSpawn>& hits) {
  return device::checked("spawning rays", [&] {
    std::vector<ToSpawn> in = hits;
    in.resize((hits.size() + 15) / 16 * 16, hits.back());
    const cl::Buffer in_buffer = context_.buffer(CL_MEM_READ_ONLY, in.size() * sizeof(ToSpawn), "hits");
    const cl::Buffer out_buffer =
        context_.buffer(CL_MEM_WRITE_ONLY, in.size() * sizeof(Spawned), "spawned rays");
    const cl::CommandQueue& queue = context_.queues().front();
    queue.enqueueWriteBuffer(in_buffer, CL_TRUE, 0, in.size() * sizeof(ToSpawn), in.data());
    using K = kernels::Spawn;
    spawn_.set(K::n, static_cast<cl_uint>(in.size())).set(K::hits, in_buffer).set(K::spawned, out_buffer);
    queue.enqueueNDRangeKernel(spawn_.ready(), cl::NullRange, cl::NDRange(in.size() / 16), cl::NDRange(1));
    std::vector<Spawned> out(in.size());
    queue.enqueueReadBuffer(out_buffer, CL_TRUE, 0, out.size() * sizeof(Spawned), out.data());
    out.resize(hits.size());
    return out;
  });
}

}  // namespace kdray::stress
