#include "odprt/plan.h"

#include <algorithm>

#include "layout/features.h"
#include "layout/rays.layout.h"

namespace kdray::odprt {

namespace {

constexpr std::uint32_t kSlices = 16, kWaves = 16;
// Where parts come and go, buffers are small, and many rays wait in the host's memory.
constexpr std::uint32_t kStreamedSlices = 16, kStreamedBatch = 256, kStreamedPool = 4 * kStreamedBatch;
constexpr std::uint32_t kStreamedRays = 1u << 20;  // of a depth
constexpr std::uint32_t kStreamedOutbox = 4096;    // rays of a slice, for all parts

// Words per field of a stream of n rays (kernels/layout/rays.layout.h).
std::uint32_t capacity_for(std::uint32_t n) {
  return (n + 2 * KDRAY_LANES - 1) / KDRAY_LANES * KDRAY_LANES;
}

// Rays that one ray can put into the pool.
std::uint32_t spawned(std::uint32_t features) {
  if (features & KDRAY_FEATURE_TRANSMIT) return 2;
  return features & KDRAY_FEATURE_REFLECT ? 1 : 0;
}

// Large batches keep packets full; several queues share what may be alive.
std::uint32_t batch_for(std::uint32_t n_queues) {
  return n_queues <= 2 ? 512 : n_queues <= 4 ? 256 : 128;
}

// Of a level: enough that no queue waits for what others hold, or a few of the buffers that were asked for.
std::uint32_t level_capacity(const PlanRequest& r, std::uint32_t batch, std::uint32_t least,
                             std::uint32_t n_slices) {
  if (r.ray_buffer > 0) return std::max(4 * r.ray_buffer, 2 * least);
  if (r.streamed) return std::max(kStreamedRays / n_slices, 4 * batch * least);
  return batch * (std::max(least, 1u) * r.n_queues + 2);
}

}  // namespace

Plan make_plan(layout::Frame& frame, const PlanRequest& r) {
  Plan plan;
  plan.n_slices = std::clamp<std::uint32_t>(frame.n_tiles, 1, r.streamed ? kStreamedSlices : kSlices);
  plan.n_waves = kWaves;
  const bool lights = (r.features & KDRAY_FEATURE_LIGHTS) != 0;
  const std::uint32_t batch = r.streamed ? kStreamedBatch : batch_for(r.n_queues),
                      n_lights = lights ? frame.n_lights : 0;
  frame.batch_size = batch;
  frame.batch_capacity = capacity_for(batch);
  frame.light_batch = std::min<std::uint32_t>(n_lights, KDRAY_MAX_LIGHT_BATCH);
  frame.shadow_capacity = std::max(frame.light_batch, 1u) * frame.batch_capacity;

  plan.least.assign(frame.max_depth + 1, std::max(spawned(r.features), 1u));
  plan.least[0] = n_lights;
  // A shadow ray is short-lived, and there may be one for every light: lights count as far as they are few.
  for (const std::uint32_t least : plan.least)
    plan.capacity.push_back(
        std::max(level_capacity(r, batch, std::min(least, 4u), plan.n_slices), 2 * least));
  const std::uint32_t largest = *std::max_element(plan.capacity.begin() + 1, plan.capacity.end());
  frame.pool_size = r.streamed ? std::min(kStreamedPool, largest) : largest;
  frame.pool_capacity = capacity_for(frame.pool_size);
  plan.shadow_pool = r.streamed ? std::min(kStreamedPool, plan.capacity[0]) : plan.capacity[0];

  OutboxShape& out = plan.outbox;
  out.n_parts = r.n_parts;
  out.n_slices = plan.n_slices;
  const std::uint32_t chosen =
      r.streamed ? std::max(kStreamedOutbox / r.n_parts, 2 * KDRAY_LANES) : 2 * batch;
  out.rays = r.ray_buffer > 0 ? r.ray_buffer : chosen;
  out.shadow = lights ? std::max(out.rays * (r.ray_buffer > 0 ? 1 : std::min(n_lights, 2u)), n_lights) : 1;
  out.ray_capacity = capacity_for(out.rays);
  out.shadow_capacity = capacity_for(out.shadow);
  return plan;
}

std::size_t work_bytes(const layout::Frame& frame, const Plan& plan, std::size_t band_pixels,
                       std::size_t n_outboxes) {
  const std::size_t pools = std::size_t{frame.max_depth} * KDRAY_TRAVEL_RAY_FIELDS * frame.pool_capacity +
                            std::size_t{KDRAY_TRAVEL_SHADOW_FIELDS} * (plan.shadow_pool + 2 * KDRAY_LANES);
  const std::size_t streams = std::size_t{KDRAY_TRAVEL_RAY_FIELDS + KDRAY_HIT_FIELDS} * frame.batch_capacity +
                              std::size_t{KDRAY_TRAVEL_SHADOW_FIELDS + 1} * frame.shadow_capacity;
  const std::size_t boxes = std::size_t{KDRAY_TRAVEL_RAY_FIELDS} * plan.outbox.ray_capacity +
                            std::size_t{KDRAY_TRAVEL_SHADOW_FIELDS} * plan.outbox.shadow_capacity;
  return plan.n_slices * sizeof(float) * (pools + streams + boxes * (n_outboxes * plan.outbox.n_parts + 1)) +
         band_pixels * 3 * sizeof(layout::i64);
}

}  // namespace kdray::odprt
