// What    Takes the shadow rays of a wave of ODPRT through their trace, where every ray has a work-item:
//         those that were just made, or, in a wave without a batch, those that came from elsewhere. What
//         nothing blocks goes on to the next part, or adds its light where none is left (odprt/shadow.clh).
// Shape   item i serves ray i % batch_size of light i / batch_size, or ray i of those from elsewhere.
// Cost    as traverse/trace_shadow.cl and film/add.cl, and 64 B for a ray that leaves.
#define KDRAY_ODPRT 1
#define KDRAY_LANES 1u
#include "layout/arguments.h"
#include "odprt/census.clh"
#include "odprt/shadow.clh"
#include "traverse/trace_slice.clh"
#include "wave/shadow_place.clh"
#include "wave/shared.clh"

// Copies a shadow ray from elsewhere to its place.
static inline void admit_shadow_ray(const Travels* t, ConstStream pool, Stream rays, u32 i) {
  const u32 from = t->traffic->n_shadow_pool + i;
  for (u32 f = 0; f < KDRAY_TRAVEL_SHADOW_FIELDS; ++f) write1(rays, f, i, read1(pool, f, from));
#if KDRAY_HAS_INSTANCES
  write1(rays, KDRAY_SHADOW_SKIP_INSTANCE, i, 0.0f);
#endif
  name_skip_by_ref(t, rays, i, as_uint(read1(pool, KDRAY_SHADOW_SKIP, from)));
}

// Returns how many leave: 0 or 1.
KDRAY_BODY u32 take_shadow_ray(const Travels* t, __constant const Frame* frame, const RaySource* source,
                               const Census* census, u32 i, bool made_here, __global i64* film) {
  trace_one(t->scene, frame, source, i);
  if (t->traffic->is_counted)
    count_visits_at(census, frame->world_max, source->rays, source->rays, true, i, true);
  if (source->occluded[i] != KDRAY_CLEAR) return 0;
  u32 n_nan = 0;
  const u32 n_left = settle_shadow_at(t, frame, true, source->rays, i, made_here, film, &n_nan);
  add_shared(&t->slice->n_nan, n_nan);
  return n_left;
}

__kernel void travel_shadow(KDRAY_PARAMETERS(KDRAY_TRAVEL_SHADOW_ARGUMENTS)) {
  __local u32 n_left_of_group, n_traced_of_group;
  const u32 item = (u32)get_global_id(0);
  const bool made_here = io_slices->n_batch > 0;
  u32 place = item, n_left = 0;
  const bool is_ray = made_here ? has_shadow_ray(frame, io_slices, io_shadow_rays, item, &place)
                                : first_light == 0 && item < io_slices->n_shadow;
  if (is_ray) {
    const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
    const Travels t = {&scene,
                       {in_cells, travel->n_cells, frame->world_max},
                       {travel, 0, 0, out_sent_shadow_rays, out_sent_counts},
                       travel,
                       io_slices,
                       0,
                       io_traffic};
    if (!made_here)
      admit_shadow_ray(
          &t, const_stream_of(in_shadow_pool, 0, KDRAY_TRAVEL_SHADOW_FIELDS, travel->shadow_pool_capacity),
          stream_of(io_shadow_rays, 0, KDRAY_SHADOW_FIELDS, frame->shadow_capacity), item);
    const RaySource source = shadow_rays(frame, 0, io_shadow_rays, io_occluded);
    const Census census = {in_subtrees, travel->n_subtrees, out_visits};
    n_left = take_shadow_ray(&t, frame, &source, &census, place, made_here, io_film);
  }
  add_of_group(&io_traffic->n_left, n_left, &n_left_of_group);
  add_of_group(&io_traffic->n_traced, is_ray ? 1u : 0u, &n_traced_of_group);
}
