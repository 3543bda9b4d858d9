// What    The extra channels of a picture (AOVs) from one eye ray per pixel, through its centre (or corner).
// Shape   One work-item per pixel; out_channels[pixel*6]: depth, normal x y z, primitive number, cost.
//         Nothing hit: depth inf, normal 0, primitive -1. A failed walk: depth NaN, which the host takes for an error.
#include "layout/features.h"
#include "raygen/primary.clh"
#include "shade/surface.clh"
#include "traverse/closest.clh"

__kernel void channels(KDRAY_SCENE_PARAMETERS, __global const VertexNormals* in_normals,
                       __constant const Frame* frame, u32 first_pixel, u32 n_pixels, __global float* out_channels) {
  const u32 item = (u32)get_global_id(0);
  if (item >= n_pixels) return;
  const SceneArrays scene = KDRAY_SCENE_ARRAYS;
  const u32 pixel = first_pixel + item;
  const u32 x = pixel % frame->width, y = pixel / frame->width;
  const float3 d = normalize3(eye_direction(frame, x, y, (float2)(0.5f, 0.5f)));
  const float3 origin = load3_constant(frame->eye);
  const float t_min = frame->hither / dot3(d, load3_constant(frame->forward));
  const TreeRay r = make_tree_ray(origin, d, t_min, INFINITY, frame->world_max);
  u32 cost = 0;
  const Hit hit =
      find_closest(&scene, &r, load3_constant(frame->root_lo), load3_constant(frame->root_hi), &cost);
  __global float* out = out_channels + (size_t)item * 6;
  float3 normal = (float3)(0.0f);
  float number = -1.0f;
  if (hit.ref < KDRAY_REF_INVALID) {
    const SurfaceArrays arrays = {in_triangles, in_normals, in_spheres, in_cones};
    normal = surface_at(&arrays, origin, d, &hit).shading;
    number = (float)primitive_number(&scene, hit.ref);
  }
  out[0] = hit.ref == KDRAY_REF_INVALID ? NAN : hit.t;
  store3(out + 1, normal);
  out[4] = number;
  out[5] = (float)cost;
}
