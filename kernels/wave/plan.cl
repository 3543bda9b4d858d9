// What    Plans the next wave where every ray has a work-item: of which depth its rays are, and how many. One
//         work-item.
// Shape   The rays of a queue are one slice's, whose next_place counts the samples of all tiles in the list,
//         and whose batch is the wave: of pooled rays the last n_batch, of eye rays the n_batch samples
//         before next_place.
// Why     admit.clh says why a depth never holds more rays than the pool has room for.
#define KDRAY_LANES 1u
#include "layout/arguments.h"
#include "raygen/choose_depth.clh"

__kernel void plan(KDRAY_PARAMETERS(KDRAY_PLAN_ARGUMENTS)) {
  if (get_global_id(0) > 0) return;
  __global Slice* wave = io_slices;
  const u32 depth = choose_depth(frame, wave, n_tiles);
  u32 n = 0;
  if (depth == 1) {
    n = take_samples(frame, wave, n_tiles, frame->batch_size);
  } else if (depth > 1) {
    const u32 n_pool = min(wave->n_pool[depth - 1], frame->pool_size);  // what found no room was counted
    n = min(n_pool, frame->batch_size);
    wave->n_pool[depth - 1] = n_pool - n;
  }
  wave->depth = depth;
  wave->eye = depth == 1;
  wave->n_batch = n;
  wave->n_waves += n > 0;
}
