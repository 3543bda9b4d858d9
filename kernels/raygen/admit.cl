// What    Fills the batch of a wave that was planned (wave/plan.cl). One ray per work-item.
// Shape   An eye ray whose sample lies outside of its tile, or that fills a run up, is none: its interval is
//         empty and its pixel KDRAY_NO_PIXEL. Films are cleared beforehand.
// Cost    reads 44 B and writes 52 B.
#define KDRAY_LANES 1u
#include "layout/arguments.h"
#include "raygen/choose_depth.clh"
#include "raygen/eye_rays.clh"
#include "wave/shared.clh"

// Writes sample `number` of the list into the batch. Returns whether it is one.
static inline bool admit_sample(__constant const Frame* frame, __global const u32* tiles, u64 number,
                                Stream batch, u32 i) {
  const u64 of_entry = samples_of_entry(frame);
  const u32 entry = (u32)(number / of_entry);
  const u64 sample = number - entry * of_entry;
#if KDRAY_HAS_ADAPTIVE
  if (frame->samples_at > 0) {
    const RunSamples s = samples_of_run(frame, tiles, tiles[entry], (u32)sample);
    write_run_samples(frame, &s, s.in ? s.place : KDRAY_NO_PIXEL, true, batch, i);
    return s.in;
  }
#endif
  const uint4 tile = tile_of(frame, tiles[entry]);
  const u32 place = (u32)(sample / frame->n_samples), k = (u32)(sample - (u64)place * frame->n_samples);
  u32 x, y;
  place_to_pixel(tile_order(frame->tile_width, frame->tile_height), place, &x, &y);
  const bool in = x < tile.z && y < tile.w;
  x += tile.x, y += tile.y;
  const u32 pixel = y * frame->width + x;
  write_eye_rays(frame, x, y, sample_offset(pixel_of_whole(frame, x, y), k, frame->n_samples), k, 1.0f,
                 in ? pixel : KDRAY_NO_PIXEL, true, batch, i);
  return in;
}

__kernel void admit(KDRAY_PARAMETERS(KDRAY_ADMIT_ARGUMENTS)) {
  __local u32 n_admitted;
  const u32 i = (u32)get_global_id(0);
  __global Slice* wave = io_slices;
  const u32 n_batch = wave->n_batch;
  const Stream batch = stream_of(out_batch, 0, KDRAY_RAY_FIELDS, frame->batch_capacity);
  bool is_eye_ray = false;
  if (i < n_batch && !wave->eye) {
    const ConstStream pool = const_pool_of_depth(in_pool, frame, 0, wave->depth);
    take_rays(pool, wave->n_pool[wave->depth - 1] + i, batch, i);
  } else if (i < n_batch) {
    is_eye_ray = admit_sample(frame, in_tiles, wave->next_place - n_batch + i, batch, i);
    if (!is_eye_ray) write1(batch, KDRAY_RAY_T_MAX, i, -INFINITY);
#if KDRAY_ODPRT
    begin_journey(batch, i);
#endif
  }
  add_of_group(&wave->n_primary, is_eye_ray ? 1u : 0u, &n_admitted);
}
