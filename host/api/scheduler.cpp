#include "api/scheduler.h"

#include <algorithm>
#include <bit>

#include "api/precision.h"

namespace kdray::api {

void Scheduler::remember(const layout::Frame& frame, const pdprt::TileCost& cost) {
  last_ = {frame.width, frame.height, cost};
}

// By what the last frame of this size told, if there was one.
std::uint32_t Scheduler::tile_side(const layout::Frame& frame) const {
  std::optional<pdprt::TileCost> measured;
  if (last_.width == frame.width && last_.height == frame.height && last_.cost.total > 0)
    measured = last_.cost;
  const std::uint32_t units =
      n_ranks_ * std::max(devices_.n_units(), static_cast<std::uint32_t>(devices_.n_queues()));
  const int tuned = devices_.first().tuned().settings.tile;  // tiles are the frame's, whatever the device
  const std::uint32_t largest = tuned > 0 ? static_cast<std::uint32_t>(tuned) : pdprt::kLargestTile;
  return pdprt::choose_tile_side(frame.width, frame.height, units, measured, largest);
}

void Scheduler::choose_tiles(wavefront::Schedule& schedule, const Job& job) const {
  const layout::Frame& frame = job.frame;
  const RenderOptions& o = job.options;
  const std::uint32_t side = tile_side(frame);
  schedule.tile_width = o.tile_width > 0 ? static_cast<std::uint32_t>(o.tile_width) : side;
  schedule.tile_height = o.tile_height > 0 ? static_cast<std::uint32_t>(o.tile_height) : side;
  // A slice counts the samples of its tile in 32 bits.
  const double tile_samples = static_cast<double>(std::min(schedule.tile_width, frame.width)) *
                              std::min(schedule.tile_height, frame.height) * frame.n_samples;
  if (tile_samples > 0xffffffff)
    throw Error(ErrorCode::usage, "a tile holds over 2^32 samples; take smaller tiles (--tile)");
}

void Scheduler::choose_slices(wavefront::Schedule& schedule, const engine::Device& device) const {
  const bool one_queue = devices_.n_queues() * n_ranks_ == 1;
  // There are enough slices that the last ones to end leave no core idle for long; each has a pool and
  // streams of its own.
  const std::uint32_t units = device.units_of_a_queue();
  schedule.n_slices = std::max(schedule.n_slices, 16 * units);
  if (!one_queue) {
    // Launches do less here, so that what a queue must have ahead of it (pdprt/queue.h) is little. On one
    // core slices would only take turns.
    schedule.n_slices = units == 1 ? 1 : 16 * units;
    schedule.fused_waves = units == 1 ? 128 : 32;
  }
  const Tuning& tuned = device.tuned().settings;
  if (tuned.batch > 0) schedule.batch_size = static_cast<std::uint32_t>(tuned.batch);
  // These were found with a single queue; several need the rule above.
  if (one_queue && tuned.slices > 0) schedule.n_slices = static_cast<std::uint32_t>(tuned.slices) * units;
  if (one_queue && tuned.waves > 0) schedule.fused_waves = static_cast<std::uint32_t>(tuned.waves);
}

// Where every ray has a work-item, a wave is to fill the device many times over: its last rays take long. It
// is no larger than the frame needs, and leaves most of the device's memory to others.
void Scheduler::choose_wave(wavefront::Schedule& schedule, const engine::Device& device,
                            const Job& job) const {
  constexpr std::uint64_t kRaysOfUnit = 8192, kLeast = 4096, kShareOfMemory = 4;
  layout::Frame frame = job.frame;
  schedule.apply(frame, job.features);
  const std::uint64_t samples =
      std::uint64_t{frame.n_tiles} * schedule.tile_width * schedule.tile_height * frame.n_samples;
  schedule.batch_size = static_cast<std::uint32_t>(
      std::clamp(kRaysOfUnit * device.units_of_a_queue(), kLeast, std::max(std::bit_ceil(samples), kLeast)));
  for (;; schedule.batch_size /= 2) {
    schedule.apply(frame, job.features);
    const std::size_t bytes = device.context.queues().size() * schedule.stream_bytes(frame, job.features);
    if (bytes <= device.context.info().global_memory / kShareOfMemory || schedule.batch_size <= kLeast)
      return;
  }
}

wavefront::Schedule Scheduler::schedule_for(const engine::Device& device, const Job& job, bool fused) const {
  wavefront::Schedule schedule;
  choose_tiles(schedule, job);
  schedule.work_group = device.work_group;
  schedule.traversal = traversal_in(job.options.precision, job.options.traversal, device.context.info());
  schedule.precision = job.options.precision;
  schedule.fused = fused;
  fused ? choose_slices(schedule, device) : choose_wave(schedule, device, job);
  // A slice without a tile would do nothing.
  const std::uint64_t tiles_x = (job.frame.width + schedule.tile_width - 1) / schedule.tile_width;
  const std::uint64_t tiles_y = (job.frame.height + schedule.tile_height - 1) / schedule.tile_height;
  schedule.n_slices =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(tiles_x * tiles_y, schedule.n_slices));
  schedule.fit(job.frame, job.features, device.context.info().max_allocation);
  return schedule;
}

}  // namespace kdray::api
