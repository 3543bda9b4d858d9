// What    A whole wave in one launch: a work-item takes its slice through all stages, admit to add.
// Shape   One work-item per slice. The same functions as the stages' own kernels, so that pictures are the
//         same.
//         The kernel itself does nothing but call: see KDRAY_APART.
// Why     A slice's streams stay in the cache of the core that works on it: stage by stage, over all slices,
//         they go through the last cache or memory between any two stages. No core waits for others between
//         stages.
// Cost    io_slices tells the cycles that each stage took, where the device has a cycle counter, and
//         io_tile_cycles those of each entry of the list: a wave is charged to the tile that its slice had
//         reached.
#include "film/add.clh"
#include "layout/arguments.h"
#include "raygen/admit.clh"
#include "shade/shade.clh"
#include "traverse/trace_slice.clh"
#include "wave/clock.clh"

KDRAY_APART void take_waves(u32 slice_id, KDRAY_PARAMETERS(KDRAY_WAVE_ARGUMENTS)) {
  if (slice_id >= n_slices) return;
  __global Slice* slice = io_slices + slice_id;
  const SceneArrays scene = KDRAY_SCENE_FROM_PARAMETERS(0);
  const SurfaceArrays arrays = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SURFACE_ARRAYS);
  const TexturingArrays texturing = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_TEXTURING_ARRAYS);
  const SkyArrays sky = KDRAY_MEMBERS_FROM_PARAMETERS(KDRAY_SKY_ARRAYS);
  const TileList list = {in_tiles, n_tiles};
  for (u32 k = 0; k < n_waves; ++k) {
    u64 since = cycles();
    const u64 start = since;
    // Behind the list's end a slice still works on what its last tile left in the pool.
    const u32 tile = slice->tile < n_tiles ? slice->tile : slice->tile - slice->tile_stride;
    admit_batch(frame, &scene, slice_id, slice, list, io_pool, io_batch, io_film);
    clock_stage(&slice->cycles_admit, &since);
    if (slice->n_batch == 0) return;
    const RaySource rays = batch_rays(frame, slice_id, io_batch, io_hits);
    trace_all(&scene, frame, &rays, slice->n_batch, slice->depth == 1, slice);
    clock_stage(&slice->cycles_closest, &since);
    u32 first_light = 0;
    do {
      shade_batch(&arrays, &texturing, &sky, in_lights, frame, slice_id, first_light, slice, io_batch,
                  io_hits, io_pool, io_shadow_rays, io_film);
      clock_stage(&slice->cycles_shade, &since);
#if KDRAY_HAS_LIGHTS
      const RaySource to_lights = shadow_rays(frame, slice_id, io_shadow_rays, io_occluded);
      trace_all(&scene, frame, &to_lights, slice->n_shadow, false, slice);
      clock_stage(&slice->cycles_shadow, &since);
      add_arrived(frame, slice_id, slice, io_shadow_rays, io_occluded, io_film);
      clock_stage(&slice->cycles_add, &since);
#endif
      first_light += frame->light_batch;
    } while (KDRAY_HAS_LIGHTS && first_light < frame->n_lights);
    io_tile_cycles[tile] += since - start;
  }
}

__kernel void wave(KDRAY_PARAMETERS(KDRAY_WAVE_ARGUMENTS)) {
  take_waves((u32)get_global_id(0), KDRAY_HAND_ON(KDRAY_WAVE_ARGUMENTS));
}
