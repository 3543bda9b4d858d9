#include "api/scheduler.h"

#include <algorithm>

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
  if (schedule.fused && !one_queue) {
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

wavefront::Schedule Scheduler::schedule_for(const engine::Device& device, const Job& job) const {
  wavefront::Schedule schedule;
  choose_tiles(schedule, job);
  schedule.work_group = device.work_group;
  schedule.traversal = traversal_in(job.options.precision, job.options.traversal, device.context.info());
  schedule.precision = job.options.precision;
  schedule.fused = !device.global;
  choose_slices(schedule, device);
  // A slice without a tile would do nothing.
  const std::uint64_t tiles_x = (job.frame.width + schedule.tile_width - 1) / schedule.tile_width;
  const std::uint64_t tiles_y = (job.frame.height + schedule.tile_height - 1) / schedule.tile_height;
  schedule.n_slices =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(tiles_x * tiles_y, schedule.n_slices));
  schedule.fit(job.frame, job.features, device.context.info().max_allocation);
  return schedule;
}

}  // namespace kdray::api
