// What    The stage add by itself: shadow rays that reached their light. One work-item per slice.
#include "film/add.clh"

__kernel void add(__constant const Frame* frame, u32 n_slices, __global Slice* io_slices,
                  __global const real* in_shadow_rays, __global const uchar* in_occluded,
                  __global i64* io_film) {
  const u32 slice = (u32)get_global_id(0);
  if (slice < n_slices) add_arrived(frame, slice, io_slices + slice, in_shadow_rays, in_occluded, io_film);
}
