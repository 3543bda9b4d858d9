// What    Plans the next wave of ODPRT where every ray has a work-item, and closes the account of the last:
//         credits and traffic are its alone. One work-item.
// Shape   The rays of a queue are one slice's. The batch is the wave, as in wave/plan.cl; or there is none,
//         and the wave is of shadow rays from elsewhere: the last n_shadow of the pool before they are taken.
// Why     choose_work.clh says why nothing overflows.
#define KDRAY_ODPRT 1
#define KDRAY_LANES 1u
#include "layout/arguments.h"
#include "odprt/choose_work.clh"
#include "raygen/choose_depth.clh"

static inline void count_made(const Account* a, u32 level, u32 n) {
  a->traffic->made[level] += n;
  a->credits->rays[level] -= n;
}
static inline void count_ended(const Account* a, u32 level, u32 n) {
  a->traffic->ended[level] += n;
  a->credits->rays[level] += n;  // what has ended leaves space for as many
}

static inline void close_wave(const Account* a) {
  __global Slice* slice = a->slice;
  __global Traffic* traffic = a->traffic;
  const u32 depth = slice->depth, n_left = (u32)traffic->n_left;
  if (slice->n_batch > 0) {
    count_made(a, 1, (u32)(slice->n_primary - traffic->n_primary_before));
    if (depth < a->frame->max_depth) count_made(a, depth + 1, slice->n_pool[depth] - traffic->n_pool_before);
    count_made(a, 0, n_left);
    count_ended(a, depth, (u32)traffic->n_ended);
  } else {
    count_ended(a, 0, slice->n_shadow - n_left);
  }
}

static inline void take_batch(const Account* a, const Work* work) {
  __global Slice* slice = a->slice;
  if (work->eye) {
    slice->n_batch = take_samples(a->frame, slice, a->n_tiles, work->n);
  } else if (work->depth > 0) {
    slice->n_pool[work->depth - 1] -= work->n;
    slice->n_batch = work->n;
  } else {
    a->traffic->n_shadow_pool -= work->n;
    slice->n_shadow = work->n;
  }
}

static inline void open_wave(const Account* a, __constant const Travel* travel) {
  __global Slice* slice = a->slice;
  __global Traffic* traffic = a->traffic;
  slice->n_batch = slice->n_shadow = 0;
  traffic->n_ended = traffic->n_left = 0;
  const Work none = {0, 0, false};
  const Work work = has_space(a, travel) ? choose_work(a) : none;
  slice->depth = work.depth;
  slice->eye = work.eye;
  if (work.n == 0) return;
  take_batch(a, &work);
  traffic->n_primary_before = slice->n_primary;
  traffic->n_pool_before = work.depth < a->frame->max_depth ? slice->n_pool[work.depth] : 0;
  traffic->is_counted = travel->n_subtrees > 0 && traffic->n_waves % travel->census_every == 0;
  ++traffic->n_waves;
}

__kernel void travel_plan(KDRAY_PARAMETERS(KDRAY_TRAVEL_PLAN_ARGUMENTS)) {
  if (get_global_id(0) > 0) return;
  const Outbox out = {travel, 0, 0, 0, out_sent_counts};
  const Account a = account_of(n_tiles, frame, io_slices, io_credits, io_traffic, &out);
  if (wave == 0) {
    begin_account(io_traffic);
    io_traffic->n_waves = 0;
  } else {
    close_wave(&a);
  }
  if (wave < n_waves) open_wave(&a, travel);
}
