// What    Query rays: the closest hit of each, or with any_hit whether anything lies inside of its interval
//         (t = 0, else inf). `space`: the scene's centre and scale (host/base/local_space.h).
// Shape   Binary and wide: one ray to a work-item. Otherwise one work-item to KDRAY_CHUNK rays.
// Cost    reads 32 B of the ray and the tree, writes 16 B.
// Errors  a full stack (binary tree) gives primitive KDRAY_QUERY_INVALID; the host checks for it.
#define KDRAY_WHOLE_TRIANGLES
// A frame learns from one wave what suits the next (learn.clh); a query has just these rays, so packets that
// fare badly end among them. Refracted rays of a fine mesh go 1.5 times as fast.
#define KDRAY_LEAST_TO_A_CHILD 4.5f
#include "layout/arguments.h"
#include "layout/traversal.h"
#include "traverse/any.clh"
#include "traverse/query.clh"
#include "traverse/query16.clh"
// Included after the source of rays, which they use.
#include "traverse/wide.clh"
#if KDRAY_LANES != 1
#include "traverse/leaving.clh"
#include "traverse/walk.clh"
#endif

#if KDRAY_TRAVERSAL == KDRAY_TRAVERSAL_BINARY
// The binary tree has its own ray and its own two forms.
static inline void query_binary(const SceneArrays* scene, const RaySource* source, u32 i, real3 root_lo,
                                real3 root_hi, float world_max) {
  RayIn in;
  fetch_ray(source, i, &in);
  const real3 o = (real3)(in.origin[0], in.origin[1], in.origin[2]);
  const real3 d = (real3)(in.direction[0], in.direction[1], in.direction[2]);
  const TreeRay r = make_tree_ray(o, d, in.t_min, in.t_max, world_max);
  if (source->any_hit) {
    const u32 found = find_any(scene, &r, root_lo, root_hi, in.skip);
    const u32 ref = found == KDRAY_OCCLUDED ? 0u : KDRAY_REF_MISS;
    store_query_hit(source, i, 0.0f, found == KDRAY_OCCLUSION_INVALID ? KDRAY_REF_INVALID : ref, 0.0f, 0.0f);
  } else {
    u32 cost;
    const Hit hit = find_closest(scene, &r, root_lo, root_hi, in.skip, &cost);
    store_query_hit(source, i, hit.t, hit.ref, hit.u, hit.v);
  }
}
#endif

KDRAY_BODY void query_item(u32 item, KDRAY_PARAMETERS(KDRAY_TRACE_QUERY_ARGUMENTS)) {
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(in_primitive_masks);
  RaySource source = ray_source(&scene, in_rays, in_ray_masks, out_hits, space, any_hit, any_length, as_refs);
#if KDRAY_HAS_INSTANCES
  source.hit_instances = out_hit_instances;
#else
  (void)out_hit_instances;
#endif
#if KDRAY_TRAVERSAL == KDRAY_TRAVERSAL_BINARY
  if (item < n_rays)
    query_binary(&scene, &source, item, convert_real3(root_lo.xyz), convert_real3(root_hi.xyz), world_max);
#elif KDRAY_TRAVERSAL == KDRAY_TRAVERSAL_WIDE
  (void)root_lo, (void)root_hi;
  if (item >= n_rays) return;
  RayIn in;
  fetch_ray(&source, item, &in);
  WideRay r;
  begin_ray(&r, &in, world_max);
  walk_wide(&scene, &r);
  store_ray(&source, item, &r);
#else
  (void)root_lo, (void)root_hi;
  const u32 first = item * KDRAY_CHUNK;
  if (first >= n_rays) return;
  RayGroups groups;
  group_all(&groups, first, min(n_rays, first + KDRAY_CHUNK));
  drop_leaving(&scene, &source, &groups, world_max);
  walk_rays(&scene, &source, &groups, world_max, false,
            KDRAY_COHERENT_DISTANCE * world_max * power_of_two(-source.exponent));
#endif
}

__kernel void trace_query(KDRAY_PARAMETERS(KDRAY_TRACE_QUERY_ARGUMENTS)) {
  query_item((u32)get_global_id(0), KDRAY_HAND_ON(KDRAY_TRACE_QUERY_ARGUMENTS));
}
