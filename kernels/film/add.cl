// What    Adds the contributions of the shadow rays that reached their light to the film.
// Shape   One work-item per slice, which owns its tile's pixels: no atomics.
// Cost    reads 17 B per shadow ray, reads and writes 24 B of film for each that arrives.
// Errors  a ray whose walk failed is counted (n_invalid) and adds nothing.
#include "film/accumulate.clh"
#include "layout/rays.layout.h"
#include "traverse/any.clh"

__kernel void add(__constant const Frame* frame, u32 n_slices, __global Slice* io_slices,
                  __global const ShadowRay* in_shadow_rays, __global const uchar* in_occluded,
                  __global i64* io_film) {
  const u32 slice_id = (u32)get_global_id(0);
  if (slice_id >= n_slices) return;
  __global Slice* slice = io_slices + slice_id;
  const size_t first = (size_t)slice_id * frame->batch_size * frame->light_batch;
  const u32 n_shadow = slice->n_shadow;
  for (u32 i = 0; i < n_shadow; ++i) {
    const uchar occluded = in_occluded[first + i];
    __global const ShadowRay* ray = in_shadow_rays + first + i;
    if (occluded == KDRAY_CLEAR) accumulate(frame, io_film, slice, ray->pixel, load3(ray->contribution));
    if (occluded == KDRAY_OCCLUSION_INVALID) ++slice->n_invalid;
  }
}
