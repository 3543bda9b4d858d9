// What    collect_hits: all hits of query rays: a list for each, sorted, of as many as fit, and whether there
//         are more. pack_hits: the lists moved together as structures of arrays, those of ray i to places[i],
//         with primitives' numbers for references (not with as_refs) and t in multiples of the direction as
//         it was given.
//         `space`: the scene's centre and scale (host/base/local_space.h).
// Shape   The wide walk has one ray to a work-item, the others KDRAY_CHUNK rays; pack_hits has one.
// Cost    collect_hits reads 32 B of the ray and the tree, writes 16 B and 16 B for each hit.
// Errors  There is no kernel in double, and none that walks the binary tree. A ray whose walk failed has
//         n_hits KDRAY_SPAN_INVALID; the host checks for it.
#define KDRAY_WHOLE_TRIANGLES
#include "layout/arguments.h"
#include "layout/traversal.h"
#include "traverse/collect_batch.clh"
#include "traverse/collect_packet.clh"

#if KDRAY_PRECISION == 32  // the wide form has no other

#if KDRAY_TRAVERSAL != KDRAY_TRAVERSAL_WIDE
// See walk_rays of walk.clh, though no packets end early.
static inline void collect_rays(const SceneArrays* scene, const RaySource* source, const Lists* lists,
                                u32 first, u32 end, float world_max, float most_apart) {
  RayGroups coherent, others;
#if KDRAY_TRAVERSAL == KDRAY_TRAVERSAL_PACKET
  (void)most_apart;
  group_all(&coherent, first, end);
  others.n = 0;
#elif KDRAY_TRAVERSAL == KDRAY_TRAVERSAL_BATCH
  (void)most_apart;
  group_all(&others, first, end);
  coherent.n = 0;
#else
  RayGroups all;
  group_all(&all, first, end);
  divide_by_coherence(source, &all, &coherent, &others, most_apart);
#endif
  if (coherent.n > 0) collect_packets(scene, source, lists, &coherent, world_max);
  if (others.n > 0) collect_batch(scene, source, lists, &others, world_max);
}
#endif

KDRAY_BODY void collect_item(u32 item, KDRAY_PARAMETERS(KDRAY_COLLECT_HITS_ARGUMENTS)) {
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(in_primitive_masks);
  const RaySource source = ray_source(&scene, in_rays, in_ray_masks, 0, space, 0, any_length, 1);
  const Lists lists = {io_hits, io_hit_instances, out_spans, goes_on ? in_after : 0, capacity};
#if KDRAY_TRAVERSAL == KDRAY_TRAVERSAL_WIDE
  if (item >= n_rays) return;
  RayIn in;
  fetch_ray(&source, item, &in);
  WideRay r;
  begin_ray(&r, &in, world_max);
  HitList list = list_of_ray(&source, &lists, item, r.t_min, r.t);
  r.t_min = list.t_min;
  collect_wide(&scene, &r, &list);
  store_list(&source, &lists, item, &list, r.ref);
#else
  const u32 first = item * KDRAY_CHUNK;
  if (first >= n_rays) return;
  collect_rays(&scene, &source, &lists, first, min(n_rays, first + KDRAY_CHUNK), world_max,
               KDRAY_COHERENT_DISTANCE * world_max * power_of_two(-source.exponent));
#endif
}

__kernel void collect_hits(KDRAY_PARAMETERS(KDRAY_COLLECT_HITS_ARGUMENTS)) {
  collect_item((u32)get_global_id(0), KDRAY_HAND_ON(KDRAY_COLLECT_HITS_ARGUMENTS));
}

__kernel void pack_hits(KDRAY_PARAMETERS(KDRAY_PACK_HITS_ARGUMENTS)) {
  const u32 i = (u32)get_global_id(0);
  if (i >= n_rays) return;
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
  const RaySource source = ray_source(&scene, in_rays, 0, 0, space, 0, any_length, 1);
  const i32 exponent = -query_exponent(&source, i) - source.exponent;
  __global const QueryHit* hits = in_hits + (size_t)i * capacity;
  const u32 n = in_spans[i].n_hits, first = in_places[i];
  for (u32 k = 0; k < n; ++k) {
    out_t[first + k] = scale_t(hits[k].t, exponent);
    const u32 ref = (u32)hits[k].primitive;
    out_primitive[first + k] = as_refs ? ref : primitive_number(&scene, ref);
#if KDRAY_HAS_INSTANCES
    out_instance[first + k] = in_hit_instances[(size_t)i * capacity + k] - 1;
#else
    (void)in_hit_instances, (void)out_instance;
#endif
    out_u[first + k] = hits[k].u;
    out_v[first + k] = hits[k].v;
  }
}

#endif
