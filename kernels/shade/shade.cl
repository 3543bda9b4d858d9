// What    The stage shade by itself, for the lights from `first_light` on. One work-item per slice.
#include "layout/arguments.h"
#include "shade/shade.clh"

__kernel void shade(KDRAY_PARAMETERS(KDRAY_SHADE_ARGUMENTS)) {
  const u32 slice = (u32)get_global_id(0);
  if (slice >= n_slices) return;
  const SurfaceArrays arrays = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SURFACE_ARRAYS);
  const TexturingArrays texturing = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_TEXTURING_ARRAYS);
  const SkyArrays sky = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SKY_ARRAYS);
  shade_batch(&arrays, &texturing, &sky, in_lights, frame, slice, first_light, io_slices + slice, in_batch,
              in_hits, io_pool, out_shadow_rays, io_film);
}
