// What    Takes rays that another queue has sent into the slices' pools. One work-item per slice.
// Shape   `place` of `n_places` in the outbox of the sender (odprt/send.clh), whose streams have these
//         capacities.
// Cost    reads and writes 64 B per ray, 60 B per shadow ray; where they go to is known.
// Errors  A pool that is full counts what finds no place (n_pool_overflow): a broken bound, which the host
//         acts on.
#define KDRAY_ODPRT 1
#include "layout/arguments.h"
#include "odprt/send.clh"
#include "wave/pool.clh"

static inline void receive_rays(__constant const Frame* frame, ConstStream from, u32 n, u32 slice_id,
                                __global Slice* slice, __global float* pool) {
  for (u32 i = 0; i < n; i += KDRAY_LANES) {
    const uintN word = as_uintN(readN(from, KDRAY_RAY_FINDER, i));
    for (Distinct d = distinct_values(KDRAY_FINDER_DEPTH(word), lanes_up_to(n - i)); d.rest != 0;) {
      const maskN same = next_lanes(&d);
      __global u32* n_pool = &slice->n_pool[d.value - 1];
      if (*n_pool + count_lanes(same) > frame->pool_size) {
        slice->n_pool_overflow += count_lanes(same);
        continue;
      }
      const Stream to = pool_of_depth(pool, frame, slice_id, d.value);
      for (u32 f = 0; f < KDRAY_RAY_FIELDS; ++f)
        appendN(to, f, *n_pool, same,
                f == KDRAY_RAY_FINDER ? as_floatN(KDRAY_FINDER_PART(word)) : readN(from, f, i));
      *n_pool += count_lanes(same);
    }
  }
}

static inline void receive_shadow_rays(__constant const Travel* travel, ConstStream from, u32 n,
                                       __global Slice* slice, __global Traffic* traffic, Stream pool) {
  if (traffic->n_shadow_pool + n > travel->shadow_pool) {
    slice->n_pool_overflow += n;
    return;
  }
  const u32 first = traffic->n_shadow_pool;
  for (u32 f = 0; f < KDRAY_TRAVEL_SHADOW_FIELDS; ++f)
    for (u32 i = 0; i < n; i += KDRAY_LANES) writeN(pool, f, first + i, readN(from, f, i));
  traffic->n_shadow_pool = first + n;
}

KDRAY_BODY void receive_slice(u32 s, KDRAY_PARAMETERS(KDRAY_RECEIVE_ARGUMENTS)) {
  if (s >= travel->n_slices) return;
  const u32 from = place * travel->n_slices + s;
  receive_rays(frame, const_stream_of(in_sent_rays, from, KDRAY_RAY_FIELDS, ray_capacity),
               in_sent_counts[from], s, io_slices + s, io_pool);
  receive_shadow_rays(travel,
                      const_stream_of(in_sent_shadow_rays, from, KDRAY_SENT_SHADOW_FIELDS, shadow_capacity),
                      in_sent_counts[n_places * travel->n_slices + from], io_slices + s, io_traffic + s,
                      stream_of(io_shadow_pool, s, KDRAY_TRAVEL_SHADOW_FIELDS, travel->shadow_pool_capacity));
}

__kernel void receive(KDRAY_PARAMETERS(KDRAY_RECEIVE_ARGUMENTS)) {
  receive_slice((u32)get_global_id(0), KDRAY_HAND_ON(KDRAY_RECEIVE_ARGUMENTS));
}
