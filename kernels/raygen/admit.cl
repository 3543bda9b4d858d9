// What    The stage admit by itself: each slice's next batch. One work-item per slice.
#include "layout/arguments.h"
#include "raygen/admit.clh"

__kernel void admit(KDRAY_PARAMETERS(KDRAY_ADMIT_ARGUMENTS)) {
  const u32 slice = (u32)get_global_id(0);
  const TileList list = {in_tiles, n_tiles};
  if (slice < n_slices) admit_batch(frame, slice, io_slices + slice, list, in_pool, out_batch, out_film);
}
