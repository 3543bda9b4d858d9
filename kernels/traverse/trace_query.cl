// What    The rays of `kdray trace`: closest hit or occlusion of rays that come from outside, one per work-item.
// Shape   in_rays[n] -> out_hits[n]. Directions of any length: they are scaled by a power of two to about unit length
//         first, which is exact, and t back again.
// Errors  a full stack gives primitive KDRAY_QUERY_INVALID; the host checks for it.
#include "layout/features.h"
#include "traverse/any.clh"
#include "traverse/closest.clh"

#define KDRAY_QUERY_INVALID -2

inline TreeRay make_query_ray(__global const QueryRay* ray, float3 center, float world_max, int* exponent) {
  const float3 direction = load3(ray->direction);
  *exponent = ilogb(max3(fabs(direction)));
  const float3 scaled = (float3)(ldexp(direction.x, -*exponent), ldexp(direction.y, -*exponent),
                                 ldexp(direction.z, -*exponent));
  return make_tree_ray(load3(ray->origin) - center, scaled, ldexp(ray->t_min, *exponent),
                       ldexp(ray->t_max, *exponent), world_max);
}

__kernel void trace_query_closest(KDRAY_SCENE_PARAMETERS, float4 root_lo, float4 root_hi, float4 center,
                                  float world_max, u32 n, __global const QueryRay* in_rays,
                                  __global QueryHit* out_hits) {
  const u32 i = (u32)get_global_id(0);
  if (i >= n) return;
  const SceneArrays scene = KDRAY_SCENE_ARRAYS;
  int exponent;
  const TreeRay r = make_query_ray(in_rays + i, center.xyz, world_max, &exponent);
  u32 cost;
  const Hit hit = find_closest(&scene, &r, root_lo.xyz, root_hi.xyz, &cost);
  QueryHit out = {INFINITY, -1, 0.0f, 0.0f};
  if (hit.ref == KDRAY_REF_INVALID) {
    out.primitive = KDRAY_QUERY_INVALID;
  } else if (hit.ref != KDRAY_REF_MISS) {
    out.t = ldexp(hit.t, -exponent);
    out.primitive = (i32)primitive_number(&scene, hit.ref);
    out.u = hit.u;
    out.v = hit.v;
  }
  out_hits[i] = out;
}

__kernel void trace_query_any(KDRAY_SCENE_PARAMETERS, float4 root_lo, float4 root_hi, float4 center,
                              float world_max, u32 n, __global const QueryRay* in_rays,
                              __global QueryHit* out_hits) {
  const u32 i = (u32)get_global_id(0);
  if (i >= n) return;
  const SceneArrays scene = KDRAY_SCENE_ARRAYS;
  int exponent;
  const TreeRay r = make_query_ray(in_rays + i, center.xyz, world_max, &exponent);
  const u32 found = find_any(&scene, &r, root_lo.xyz, root_hi.xyz, KDRAY_REF_MISS);
  const QueryHit out = {found == KDRAY_OCCLUDED ? 0.0f : INFINITY,
                        found == KDRAY_OCCLUSION_INVALID ? KDRAY_QUERY_INVALID : -1, 0.0f, 0.0f};
  out_hits[i] = out;
}
