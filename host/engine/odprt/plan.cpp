#include "engine/odprt/plan.h"

#include <algorithm>

#include "engine/wavefront/slice_buffers.h"
#include "layout/features.h"
#include "layout/rays.layout.h"

namespace kdray::odprt {

namespace {

using wavefront::capacity_for, wavefront::spawned_per_ray;

constexpr std::uint32_t kBatch = 512;                     // large batches keep packets full
constexpr std::uint32_t kWaves = 16, kLaunchWaves = 256;  // of a slice in a launch, and of all slices
constexpr std::uint32_t kRayWaves = 8;                    // ... where every ray has a work-item
// For all slices together, how many rays of a depth may be alive, and how many an outbox holds for a part.
constexpr std::uint32_t kPoolRays = 1u << 16, kOutboxRays = 1u << 13;
constexpr std::uint32_t kMostPlaces = 4;
// Shadow rays that may leave where there is nowhere to go.
constexpr std::uint32_t kAnyNumber = 1u << 30;
// Where every ray has a work-item, all lights' shadow rays of so many rays have space, as far as that is not
// too much: a wave is many launches where there are many lights.
constexpr std::uint64_t kLitRays = 256, kMostLit = 1u << 22;
// Where the host sorts: rays that may wait in its memory, in a queue's pool, and in the outbox.
constexpr std::uint32_t kStreamedRays = 1u << 20, kStreamedPool = 1u << 14, kStreamedOutbox = 1u << 16;

// How many rays of a level a slice may have: enough that no queue waits for what others hold, or a few of the
// buffers that were asked for; and so many that, whoever has the credits for them, some rank has twice what a
// ray needs (rank_exchange.h).
std::uint32_t level_capacity(const PlanRequest& r, std::uint32_t batch, std::uint32_t least,
                             std::uint32_t n_slices) {
  if (r.ray_buffer > 0) return std::max(4 * r.ray_buffer, 2 * least * r.n_ranks);
  const std::uint32_t in_work = batch * (std::min(least, 4u) * r.n_queues + 2);
  return std::max({(r.streamed ? kStreamedRays : kPoolRays) / n_slices, in_work, 2 * least * r.n_ranks});
}

constexpr std::size_t kRayBytes = KDRAY_TRAVEL_RAY_FIELDS * sizeof(float);
// The bytes of a ray on its way and of two shadow rays.
constexpr std::size_t kSentBytes = kRayBytes + 2 * KDRAY_SENT_SHADOW_FIELDS * sizeof(float);
constexpr std::size_t kPoolShare = 32, kOutboxShare = 8,
                      kBatchShare = 8;  // of memory that is short: that part of it

// Rays of a batch: as many as are asked for, fewer where buffers are small or memory is short.
std::uint32_t batch_of(const PlanRequest& r, std::uint32_t light_batch) {
  if (r.wave_rays == 0) return kBatch;
  if (r.ray_buffer > 0) return std::min(r.wave_rays, r.ray_buffer);
  if (!r.streamed) return r.wave_rays;
  const std::size_t of_ray =
      kRayBytes + (KDRAY_HIT_FIELDS + light_batch * (KDRAY_TRAVEL_SHADOW_FIELDS + 2)) * sizeof(float);
  return static_cast<std::uint32_t>(
      std::clamp<std::size_t>(r.memory / kBatchShare / of_ray, kBatch, std::max(kBatch, r.wave_rays)));
}

// Rays for one place and slice.
std::uint32_t outbox_rays(const PlanRequest& r, std::uint32_t batch, std::uint32_t n_slices) {
  if (r.ray_buffer > 0) return r.ray_buffer;
  if (!r.streamed) return std::max(kOutboxRays / n_slices, r.wave_rays > 0 ? batch : 2 * batch);
  return static_cast<std::uint32_t>(
      std::clamp<std::size_t>(r.memory / kOutboxShare / kSentBytes / n_slices, KDRAY_LANES,
                              std::max(kStreamedOutbox / n_slices, kBatch / 4)));
}

// Rays of one depth that a slice's pool holds, where that is less than what may be alive.
std::uint32_t streamed_pool(const PlanRequest& r, std::uint32_t batch, std::uint32_t n_slices,
                            std::uint32_t max_depth) {
  const std::uint32_t most = std::max(kStreamedPool, 4 * batch);
  if (!r.streamed) return most;
  return static_cast<std::uint32_t>(
      std::clamp<std::size_t>(r.memory / kPoolShare / kRayBytes / max_depth / n_slices, 2 * kBatch, most));
}

}  // namespace

bool host_sorts(const PlanRequest& r) {
  return r.streamed || r.n_parts > kMostPlaces;
}

BufferPlan make_plan(layout::Frame& frame, const PlanRequest& r) {
  BufferPlan plan;
  plan.per_ray = r.wave_rays > 0;
  plan.n_slices = plan.per_ray ? 1 : std::clamp<std::uint32_t>(frame.n_tiles, 1, r.n_slices);
  plan.n_waves = plan.per_ray ? kRayWaves : std::max(kWaves, kLaunchWaves / plan.n_slices);
  const bool lights = (r.features & KDRAY_FEATURE_LIGHTS) != 0;
  const std::uint32_t n_lights = lights ? frame.n_lights : 0;
  frame.light_batch = std::min<std::uint32_t>(n_lights, KDRAY_MAX_LIGHT_BATCH);
  const std::uint32_t batch = batch_of(r, frame.light_batch);
  frame.batch_size = batch;
  frame.batch_capacity = capacity_for(batch);
  frame.shadow_capacity = std::max(frame.light_batch, 1u) * frame.batch_capacity;

  plan.least.assign(frame.max_depth + 1, std::max(spawned_per_ray(r.features), 1u));
  plan.least[0] = n_lights;
  for (const std::uint32_t least : plan.least)
    plan.capacity.push_back(level_capacity(r, batch, least, plan.n_slices));
  const auto lit = static_cast<std::uint32_t>(
      plan.per_ray && r.ray_buffer == 0 && !r.streamed ? std::min(n_lights * kLitRays, kMostLit) : 0);
  plan.capacity[0] = std::max(plan.capacity[0], lit * (r.n_queues + 1));
  const std::uint32_t largest = *std::max_element(plan.capacity.begin() + 1, plan.capacity.end());
  const std::uint32_t streamed = streamed_pool(r, batch, plan.n_slices, frame.max_depth);
  const bool sorts = host_sorts(r);
  frame.pool_size = sorts ? std::min(streamed, largest) : largest;
  frame.pool_capacity = capacity_for(frame.pool_size);
  plan.shadow_pool = r.n_parts == 1 ? 1 : sorts ? std::min(streamed, plan.capacity[0]) : plan.capacity[0];

  OutboxShape& out = plan.outbox;
  // Few parts are what most of a launch's rays go to: where all are copied, they share the outbox.
  out.n_places = sorts ? 1 : r.n_parts;
  out.n_slices = plan.n_slices;
  out.ray_fields = wavefront::travel_ray_fields(r.features);
  out.rays = outbox_rays(r, batch, plan.n_slices);
  out.shadow = lights ? std::max({r.ray_buffer > 0 ? out.rays : 2 * out.rays, n_lights, lit}) : 1;
  // Where there is one part nothing is ever sent.
  out.ray_capacity = capacity_for(r.n_parts > 1 ? out.rays : 0);
  out.shadow_capacity = capacity_for(r.n_parts > 1 ? out.shadow : 0);
  OutboxShape& in = plan.inbox;
  in.n_places = 1;
  in.ray_fields = out.ray_fields;
  in.n_slices = plan.n_slices;
  in.rays = frame.pool_size;
  in.shadow = plan.shadow_pool;
  in.ray_capacity = capacity_for(r.n_parts > 1 ? in.rays : 0);
  in.shadow_capacity = capacity_for(r.n_parts > 1 ? in.shadow : 0);
  if (r.n_parts == 1) plan.capacity[0] = out.shadow = kAnyNumber;
  return plan;
}

std::size_t work_bytes(const layout::Frame& frame, const BufferPlan& plan, std::size_t band_pixels,
                       std::size_t n_outboxes) {
  const std::size_t pools = std::size_t{frame.max_depth} * plan.outbox.ray_fields * frame.pool_capacity +
                            std::size_t{KDRAY_TRAVEL_SHADOW_FIELDS} * (plan.shadow_pool + 2 * KDRAY_LANES);
  const std::size_t streams =
      std::size_t{plan.outbox.ray_fields + KDRAY_HIT_FIELDS + 1} * frame.batch_capacity +
      std::size_t{KDRAY_TRAVEL_SHADOW_FIELDS + 2} * frame.shadow_capacity;
  const auto words = [](const OutboxShape& box) {
    return std::size_t{box.ray_fields} * box.ray_capacity +
           std::size_t{KDRAY_SENT_SHADOW_FIELDS} * box.shadow_capacity;
  };
  const std::size_t boxes = words(plan.outbox) * n_outboxes * plan.outbox.n_places + words(plan.inbox);
  return plan.n_slices * sizeof(float) * (pools + streams + boxes) + band_pixels * 3 * sizeof(layout::i64);
}

}  // namespace kdray::odprt
