// What    The stage admit by itself: each slice's next batch. One work-item per slice.
#include "raygen/admit.clh"

__kernel void admit(__constant const Frame* frame, u32 n_slices, __global Slice* io_slices,
                    __global const u32* in_tiles, u32 n_tiles, __global const real* in_pool,
                    __global real* out_batch, __global i64* out_film) {
  const u32 slice = (u32)get_global_id(0);
  const TileList list = {in_tiles, n_tiles};
  if (slice < n_slices) admit_batch(frame, slice, io_slices + slice, list, in_pool, out_batch, out_film);
}
