// What    Some waves of ODPRT in one launch: a work-item takes its slice through them, tracing rays in its
//         part of the scene, and puts those that go on elsewhere into the outbox.
// Shape   One work-item per slice. The stages are those of wave/wave.cl, and two more: rays are routed before
//         and after their trace. It ends when a slice has done n_waves, has nothing left that it may do, or
//         has no space for a batch in the outbox.
// Errors  as the stages'; all counted in the slice and its traffic, which the host reads after each launch.
#define KDRAY_ODPRT 1
#include "film/add.clh"
#include "layout/arguments.h"
#include "odprt/admit.clh"
#include "odprt/census.clh"
#include "odprt/rays.clh"
#include "odprt/shadow.clh"
#include "shade/shade.clh"
#include "traverse/trace_slice.clh"
#include "wave/clock.clh"

// A slice's streams.
typedef struct Streams {
  __global float *pool, *batch, *hits, *shadow_rays, *shadow_pool;
  __global uchar* occluded;
  __global i64* film;
} Streams;

typedef struct Shaders {
  SurfaceArrays surfaces;
  TexturingArrays texturing;
  SkyArrays sky;
  __global const Light* lights;
} Shaders;

#if KDRAY_HAS_LIGHTS
static inline void trace_shadow_rays(const Travels* t, __constant const Frame* frame, u32 slice_id,
                                     const Census* census, const Streams* s, bool made_here, u64* since) {
  const RaySource source = shadow_rays(frame, slice_id, s->shadow_rays, s->occluded);
  trace_all(t->scene, frame, &source, t->slice->n_shadow, false, t->slice);
  t->traffic->n_traced += t->slice->n_shadow;
  clock_stage(&t->slice->cycles_shadow, since);
  if (census) count_visits(census, frame->world_max, source.rays, source.rays, true, t->slice->n_shadow);
  settle_shadow_rays(t, frame, source.rays, source.occluded, made_here, s->film);
  clock_stage(&t->slice->cycles_add, since);
}
#endif

static inline void shade_and_light(const Travels* t, __constant const Frame* frame, u32 slice_id,
                                   const Shaders* shaders, const Census* census, const Streams* s,
                                   u64* since) {
  u32 first_light = 0;
  do {
    const u32 before = t->slice->n_pool[t->slice->depth];
    shade_batch(&shaders->surfaces, &shaders->texturing, &shaders->sky, shaders->lights, frame, slice_id,
                first_light, t->slice, s->batch, s->hits, s->pool, s->shadow_rays, s->film);
    const u32 made = t->slice->depth < frame->max_depth ? t->slice->n_pool[t->slice->depth] - before : 0;
    if (made > 0) {
      t->traffic->made[t->slice->depth + 1] += made;
      t->credits->rays[t->slice->depth + 1] -= made;
    }
    clock_stage(&t->slice->cycles_shade, since);
#if KDRAY_HAS_LIGHTS
    trace_shadow_rays(t, frame, slice_id, census, s, true, since);
#endif
    first_light += frame->light_batch;
  } while (KDRAY_HAS_LIGHTS && first_light < frame->n_lights);
}

static inline void trace_and_shade(const Travels* t, __constant const Frame* frame, u32 slice_id,
                                   const Shaders* shaders, const Census* census, const Streams* s, bool eye,
                                   u64* since) {
  const RaySource rays = batch_rays(frame, slice_id, s->batch, s->hits);
  const Stream batch = stream_of(s->batch, slice_id, KDRAY_RAY_FIELDS, frame->batch_capacity);
  const ConstStream hits = const_stream_of(s->hits, slice_id, KDRAY_HIT_FIELDS, frame->batch_capacity);
  send_fresh_rays(t, rays.rays, batch);
  clock_stage(&t->traffic->cycles_route, since);
  trace_all(t->scene, frame, &rays, t->slice->n_batch, eye, t->slice);
  t->traffic->n_traced += t->slice->n_batch;
  clock_stage(&t->slice->cycles_closest, since);
  if (census) count_visits(census, frame->world_max, rays.rays, hits, false, t->slice->n_batch);
  settle_rays(t, rays.rays, batch, hits, rays.hits);
  clock_stage(&t->traffic->cycles_route, since);
  shade_and_light(t, frame, slice_id, shaders, census, s, since);
}

// Returns false when nothing could be done.
static inline bool run_wave(const Travels* t, TileList tiles, __constant const Frame* frame, u32 slice_id,
                            const Shaders* shaders, const Census* census, const Streams* s) {
  u64 since = cycles();
  const Account account = account_of(tiles.n, frame, t->slice, t->credits, t->traffic, &t->out);
  if (!has_space(&account, t->travel)) return false;
  const Work work = choose_work(&account);
  if (work.n == 0) return false;
  if (work.depth == 0) {
#if KDRAY_HAS_LIGHTS
    admit_shadow_rays(t, frame, work.n,
                      const_stream_of(s->shadow_pool, slice_id, KDRAY_TRAVEL_SHADOW_FIELDS,
                                      t->travel->shadow_pool_capacity),
                      stream_of(s->shadow_rays, slice_id, KDRAY_SHADOW_FIELDS, frame->shadow_capacity),
                      s->film);
    clock_stage(&t->slice->cycles_admit, &since);
    trace_shadow_rays(t, frame, slice_id, census, s, false, &since);
#endif
    return true;
  }
  admit_rays(&account, tiles, &work, slice_id, s->pool,
             stream_of(s->batch, slice_id, KDRAY_RAY_FIELDS, frame->batch_capacity), s->film);
  clock_stage(&t->slice->cycles_admit, &since);
  trace_and_shade(t, frame, slice_id, shaders, census, s, work.eye, &since);
  return true;
}

KDRAY_APART void take_waves(u32 slice_id, KDRAY_PARAMETERS(KDRAY_TRAVEL_WAVE_ARGUMENTS)) {
  if (slice_id >= travel->n_slices) return;
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
  const Travels t = {&scene,
                     {in_cells, travel->n_cells, frame->world_max},
                     {travel, slice_id, out_sent_rays, out_sent_shadow_rays, out_sent_counts},
                     travel,
                     io_slices + slice_id,
                     io_credits + slice_id,
                     io_traffic + slice_id};
  const Shaders shaders = {KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SURFACE_ARRAYS),
                           KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_TEXTURING_ARRAYS),
                           KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SKY_ARRAYS), in_lights};
  const Streams streams = {io_pool, io_batch, io_hits, io_shadow_rays, io_shadow_pool, io_occluded, io_film};
  const Census census = {in_subtrees, travel->n_subtrees,
                         out_visits + (size_t)slice_id * 2 * travel->n_subtrees};
  const TileList tiles = {in_tiles, n_tiles};
  begin_account(t.traffic);
  u32 n = 0;
  for (; n < n_waves; ++n) {
    const bool counted = travel->n_subtrees > 0 && n % travel->census_every == 0;
    if (!run_wave(&t, tiles, frame, slice_id, &shaders, counted ? &census : 0, &streams)) break;
  }
  t.traffic->n_waves = n;
}

__kernel void travel_wave(KDRAY_PARAMETERS(KDRAY_TRAVEL_WAVE_ARGUMENTS)) {
  take_waves((u32)get_global_id(0), KDRAY_HAND_ON(KDRAY_TRAVEL_WAVE_ARGUMENTS));
}
