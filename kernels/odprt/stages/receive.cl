// What    Takes rays that another queue has sent into the pools, where every ray has a work-item: item i
//         takes ray i and shadow ray i.
// Shape   as odprt/receive.cl, of one slice.
// Cost    reads and writes 64 B per ray, 60 B per shadow ray.
// Errors  A pool that is full counts what finds no place (n_pool_overflow): a broken bound, which the host
//         acts on.
#define KDRAY_ODPRT 1
#define KDRAY_LANES 1u
#include "layout/arguments.h"
#include "odprt/send.clh"
#include "wave/pool.clh"
#include "wave/shared.clh"

static inline bool receive_ray(__constant const Frame* frame, ConstStream from, u32 i, __global Slice* slice,
                               __global float* pool) {
  const u32 word = as_uint(read1(from, KDRAY_RAY_FINDER, i)), depth = KDRAY_FINDER_DEPTH(word);
  const u32 place = take_places(&slice->n_pool[depth - 1], 1);
  if (place >= frame->pool_size) return false;
  const Stream to = pool_of_depth(pool, frame, 0, depth);
  for (u32 f = 0; f < KDRAY_RAY_FIELDS; ++f) write1(to, f, place, read1(from, f, i));
  write1(to, KDRAY_RAY_FINDER, place, as_float(KDRAY_FINDER_PART(word)));
  return true;
}

static inline bool receive_shadow_ray(__constant const Travel* travel, ConstStream from, u32 i,
                                      __global Traffic* traffic, Stream pool) {
  const u32 place = take_places(&traffic->n_shadow_pool, 1);
  if (place >= travel->shadow_pool) return false;
  for (u32 f = 0; f < KDRAY_TRAVEL_SHADOW_FIELDS; ++f) write1(pool, f, place, read1(from, f, i));
  return true;
}

__kernel void travel_receive(KDRAY_PARAMETERS(KDRAY_RECEIVE_ARGUMENTS)) {
  const u32 i = (u32)get_global_id(0);
  bool fits = true;
  if (i < in_sent_counts[place])
    fits = receive_ray(frame, const_stream_of(in_sent_rays, place, KDRAY_RAY_FIELDS, ray_capacity), i,
                       io_slices, io_pool);
  if (i < in_sent_counts[n_places + place])
    fits &= receive_shadow_ray(
        travel, const_stream_of(in_sent_shadow_rays, place, KDRAY_SENT_SHADOW_FIELDS, shadow_capacity), i,
        io_traffic, stream_of(io_shadow_pool, 0, KDRAY_TRAVEL_SHADOW_FIELDS, travel->shadow_pool_capacity));
  if (!fits) add_shared(&io_slices->n_pool_overflow, 1);
}
