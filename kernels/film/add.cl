// What    The stage add by itself: shadow rays that reached their light. One work-item per slice.
#include "film/add.clh"
#include "layout/arguments.h"

__kernel void add(KDRAY_PARAMETERS(KDRAY_ADD_ARGUMENTS)) {
  const u32 slice = (u32)get_global_id(0);
  if (slice < n_slices) add_arrived(frame, slice, io_slices + slice, in_shadow_rays, in_occluded, io_film);
}
