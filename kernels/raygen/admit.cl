// What    Makes up each slice's next batch: its pool's deepest rays, topped up with eye rays of its tile.
// Shape   One work-item per slice. out_batch[slice*batch_size ...] ascends in depth: eye rays first, the pool's top
//         after them; so does the pool, always.
// Why     Deepest first bounds the pool: when a batch holds rays of depth j, it holds all that are deeper, so what lies
//         above depth j afterwards came from it alone, at most 2*batch_size rays; nested over the depths that is
//         max_depth*batch_size at the most. Eye rays are admitted only when the pool is emptied by the batch.
// Cost    reads 48 B and writes 48 B per ray.
#include "raygen/primary.clh"

__kernel void admit(__constant const Frame* frame, u32 n_slices, __global Slice* io_slices,
                    __global const Ray* in_pool, __global Ray* out_batch) {
  const u32 slice_id = (u32)get_global_id(0);
  if (slice_id >= n_slices) return;
  __global Slice* slice = io_slices + slice_id;
  __global const Ray* pool = in_pool + (size_t)slice_id * frame->pool_size;
  __global Ray* batch = out_batch + (size_t)slice_id * frame->batch_size;
  u32 n_pool = slice->n_pool;
  const u32 from_pool = min(n_pool, frame->batch_size);
  u32 n_batch = 0;
  while (n_batch + from_pool < frame->batch_size && slice->tile < slice->end_tile) {
    const u32 tile_x = (slice->tile % frame->n_tiles_x) * frame->tile_width;
    const u32 tile_y = (slice->tile / frame->n_tiles_x) * frame->tile_height;
    const u32 tile_w = min(frame->tile_width, frame->width - tile_x);
    const u32 tile_h = min(frame->tile_height, frame->height - tile_y);
    const u32 n_in_tile = tile_w * tile_h * frame->n_samples;
    u32 next = slice->next_sample;
    while (next < n_in_tile && n_batch + from_pool < frame->batch_size) {
      const u32 place = next / frame->n_samples;
      batch[n_batch++] =
          eye_ray(frame, tile_x + place % tile_w, tile_y + place / tile_w, next % frame->n_samples);
      ++next;
    }
    if (next == n_in_tile) {
      slice->tile += slice->tile_stride;
      next = 0;
    }
    slice->next_sample = next;
  }
  slice->n_primary += n_batch;
  for (u32 i = n_pool - from_pool; i < n_pool; ++i) batch[n_batch++] = pool[i];
  slice->n_pool = n_pool - from_pool;
  slice->n_batch = n_batch;
  slice->n_shadow = 0;
}
