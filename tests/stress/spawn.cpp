#include "stress/spawn.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "device/opencl_error.h"
#include "device/simd.h"

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

Real3x16 gather3(__global const float* first) {
  Lanes x, y, z;
  FOR_LANES {
    __global const float* p = first + k * (sizeof(ToSpawn) / sizeof(float));
    x.f[k] = p[0], y.f[k] = p[1], z.f[k] = p[2];
  }
  const Real3x16 r = {x.v, y.v, z.v};
  return r;
}
float16 gather(__global const float* first) {
  Lanes x;
  FOR_LANES x.f[k] = first[k * (sizeof(ToSpawn) / sizeof(float))];
  return x.v;
}
void scatter3(Real3x16 v, __global float* first) {
  Lanes x, y, z;
  x.v = v.x, y.v = v.y, z.v = v.z;
  FOR_LANES {
    __global float* p = first + k * (sizeof(Spawned) / sizeof(float));
    p[0] = x.f[k], p[1] = y.f[k], p[2] = z.f[k];
  }
}

// n: a multiple of sixteen.
__kernel void spawn(__global const Triangle* triangles, __global const VertexNormals* normals,
                    __global const Sphere* spheres, __global const Cone* cones, __global const ToSpawn* in,
                    __global Spawned* out, uint n) {
  const uint i = 16 * (uint)get_global_id(0);
  if (i >= n) return;
  in += i;
  out += i;
  const SurfaceArrays arrays = {triangles, normals, spheres, cones};
  const Real3x16 o = gather3(in->origin), d = gather3(in->direction), light = gather3(in->light);
  const Hits hits = {gather(&in->t), as_uint16(gather((__global const float*)&in->ref)), gather(&in->u),
                     gather(&in->v)};
  const lanes16 hit = hits.ref < KDRAY_REF_INVALID;
  Surface s;
  surfaces_at(&arrays, o, d, &hits, hit, &s);
  // As shade.clh has it.
  const float16 index = gather(&in->index), eta = s.inside ? index : 1.0f / index;
  Real3x16 refracted;
  const lanes16 refracts = refracted_direction(d, s.shading, s.normal, eta, &refracted);
  const Real3x16 above = offset_origin(s.point, s.point_error, s.normal);
  const Real3x16 light_origin = offset_origin(s.light_end, s.point_error, s.normal);
  const Real3x16 way = sub3(light, s.point);
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

std::string options_for(const device::Context& context, std::uint32_t features) {
  std::string options = fmt::format("-cl-std=CL1.2 -DKDRAY_FEATURES={:#010x}u {}", features,
                                    device::build_option(context.simd()));
  if (context.rounds_division_correctly()) options += " -cl-fp32-correctly-rounded-divide-sqrt";
  return options;
}

template <class Values>
cl::Buffer copy_of(const device::Context& context, const Values& values) {
  return context.upload_copy(values.data(), values.size() * sizeof(values[0]), "a scene");
}

}  // namespace

Spawner::Spawner(const prepare::Prepared& scene) : context_("auto", 1) {
  kernel_ =
      cl::Kernel(context_.build_text("spawn.cl", kSource, options_for(context_, scene.features)), "spawn");
  const flatten::FlatScene& flat = scene.flat;
  arrays_ = {copy_of(context_, flat.triangles), copy_of(context_, flat.normals),
             copy_of(context_, flat.spheres), copy_of(context_, flat.cones)};
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
    for (cl_uint i = 0; i < arrays_.size(); ++i) kernel_.setArg(i, arrays_[i]);
    kernel_.setArg(4, in_buffer);
    kernel_.setArg(5, out_buffer);
    kernel_.setArg(6, static_cast<cl_uint>(in.size()));
    queue.enqueueNDRangeKernel(kernel_, cl::NullRange, cl::NDRange(in.size() / 16), cl::NDRange(1));
    std::vector<Spawned> out(in.size());
    queue.enqueueReadBuffer(out_buffer, CL_TRUE, 0, out.size() * sizeof(Spawned), out.data());
    out.resize(hits.size());
    return out;
  });
}

}  // namespace kdray::stress
