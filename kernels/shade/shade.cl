// What    The stage shade by itself, for the lights from `first_light` on. One work-item per slice.
#include "shade/shade.clh"

__kernel void shade(__global const Triangle* in_triangles, __global const VertexNormals* in_normals,
                    __global const Sphere* in_spheres, __global const Cone* in_cones,
                    __global const Material* in_materials, __global const Light* in_lights,
                    __constant const Frame* frame, u32 n_slices, u32 first_light, __global Slice* io_slices,
                    __global const real* in_batch, __global const real* in_hits, __global real* io_pool,
                    __global real* out_shadow_rays, __global i64* io_film) {
  const u32 slice = (u32)get_global_id(0);
  if (slice >= n_slices) return;
  const SurfaceArrays arrays = {in_triangles, in_normals, in_spheres, in_cones};
  shade_batch(&arrays, in_materials, in_lights, frame, slice, first_light, io_slices + slice, in_batch,
              in_hits, io_pool, out_shadow_rays, io_film);
}
