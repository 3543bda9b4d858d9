// What    How large the pools and buffers of ODPRT's queues are. A choice changes time and memory, never the
//         picture.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/odprt/outbox.h"
#include "layout/features.h"
#include "layout/frame.layout.h"

namespace kdray::odprt {

struct BufferPlan {
  bool per_ray = false;  // every ray has a work-item, and there is one slice
  std::uint32_t n_slices = 0;
  std::uint32_t n_waves = 0;            // of a slice in one launch, at most
  std::vector<std::uint32_t> capacity;  // of the levels (ray_credits.h)
  std::vector<std::uint32_t> least;     // what one ray may make: the least that is of use in a launch
  std::uint32_t shadow_pool = 0;        // shadow rays from elsewhere that a slice can hold
  OutboxShape outbox;
  OutboxShape inbox;  // of one part: rays from the host's memory
};

// What is asked of a plan.
struct PlanRequest {
  layout::Features features = 0;
  std::uint32_t n_parts = 1, n_queues = 1, n_ranks = 1;  // of all ranks
  std::uint32_t n_slices = 16;                           // of each queue
  std::uint32_t wave_rays = 0;                           // where every ray has a work-item; else 0
  std::uint32_t ray_buffer = 0;                          // rays in a place of the outbox; 0: chosen
  std::size_t memory = 0;  // of a queue, when streamed: buffers take a part of it
  bool streamed = false;   // parts come and go: rays wait in the host's memory, and there may be many
};

// Whether all rays go through the host, which sorts them: where parts come and go, or where there are so many
// that a place for each, and pools for all that may come, would take too much. Rays that find no space on the
// device wait in the host's memory.
bool host_sorts(const PlanRequest& request);

// `frame` has tiles; its batch, pool and shadow sizes are set.
BufferPlan make_plan(layout::Frame& frame, const PlanRequest& request);

// What a worker takes beside geometry, with `n_outboxes` outboxes.
std::size_t work_bytes(const layout::Frame& frame, const BufferPlan& plan, std::size_t band_pixels,
                       std::size_t n_outboxes);

}  // namespace kdray::odprt
