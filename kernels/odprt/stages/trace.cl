// What    Takes the rays of a wave of ODPRT through their trace, where every ray has a work-item: a fresh one
//         whose way begins elsewhere is sent there; the others are traced, and sent on where their best hit
//         may still be beaten elsewhere (odprt/rays.clh).
// Shape   What has left is no ray any more: its interval is empty and its pixel KDRAY_NO_PIXEL.
// Cost    as traverse/trace_closest.cl, and 64 B for a ray that leaves.
// Errors  a ray that is lost is counted in the traffic.
#define KDRAY_ODPRT 1
#define KDRAY_LANES 1u
#include "layout/arguments.h"
#include "odprt/census.clh"
#include "odprt/rays.clh"
#include "traverse/trace_slice.clh"
#include "wave/shared.clh"

// Returns whether the ray is to be shaded here.
KDRAY_BODY bool take_ray(const Travels* t, __constant const Frame* frame, const RaySource* source,
                         const Census* census, u32 i, u32* n_traced) {
  if (send_fresh_at(t, true, source->rays, i)) return false;
  trace_one(t->scene, frame, source, i);
  ++*n_traced;
  const ConstStream hits = {source->hits.words, source->hits.capacity};
  if (t->traffic->is_counted) count_visits_at(census, frame->world_max, source->rays, hits, false, i, true);
  u32 n_lost = 0;
  const bool leaves = settle_at(t, true, source->rays, hits, i, &n_lost);
  if (n_lost > 0) atomic_inc((volatile __global u32*)&t->traffic->n_lost);
  return !leaves;
}

__kernel void travel_trace(KDRAY_PARAMETERS(KDRAY_TRAVEL_TRACE_ARGUMENTS)) {
  __local u32 n_ended_of_group, n_traced_of_group;
  const u32 i = (u32)get_global_id(0);
  u32 n_ended = 0, n_traced = 0;
  const RaySource source = batch_rays(frame, 0, io_batch, io_hits);
  if (i < io_slices->n_batch && as_uint(read1(source.rays, KDRAY_RAY_PIXEL, i)) != KDRAY_NO_PIXEL) {
    const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
    const Travels t = {&scene,
                       {in_cells, travel->n_cells, frame->world_max},
                       {travel, 0, out_sent_rays, 0, out_sent_counts},
                       travel,
                       io_slices,
                       0,
                       io_traffic};
    const Census census = {in_subtrees, travel->n_subtrees, out_visits};
    const Stream batch = stream_of(io_batch, 0, KDRAY_RAY_FIELDS, frame->batch_capacity);
    if (take_ray(&t, frame, &source, &census, i, &n_traced)) {
      n_ended = 1;
    } else {
      write1(batch, KDRAY_RAY_T_MAX, i, -INFINITY);
      write1(batch, KDRAY_RAY_PIXEL, i, as_float(KDRAY_NO_PIXEL));
    }
  }
  add_of_group(&io_traffic->n_ended, n_ended, &n_ended_of_group);
  add_of_group(&io_traffic->n_traced, n_traced, &n_traced_of_group);
}
