#include "engine/odprt/cost_probe.h"

#include "engine/odprt/executor.h"

namespace kdray::odprt {

namespace {

constexpr std::uint32_t kShrink = 8;  // pixels of the frame to one of the probe's, along each side
constexpr std::uint32_t kTile = 16;

// The same view in fewer pixels: each looks along the middle of those that it stands for.
layout::Frame small_frame(layout::Frame frame) {
  frame.width = (frame.width + kShrink - 1) / kShrink;
  frame.height = (frame.height + kShrink - 1) / kShrink;
  frame.x_scale *= kShrink;
  frame.y_scale *= kShrink;
  frame.n_samples = 1;
  frame.tile_width = frame.tile_height = kTile;
  frame.n_tiles_x = (frame.width + kTile - 1) / kTile;
  frame.n_tiles = frame.n_tiles_x * ((frame.height + kTile - 1) / kTile);
  return frame;
}

}  // namespace

std::vector<SubtreeUse> probe_costs(const Request& request, const Division& whole, const Cut& cut) {
  Request probe = request;
  probe.queues.resize(1);
  probe.table = alone(1);
  probe.n_slices = (request.n_slices + 3) / 4;  // its tiles are few
  probe.frame = small_frame(request.frame);
  probe.adaptive_target = 0;
  probe.census_every = 1;
  probe.device_memory = 0;
  probe.timeline = nullptr;
  probe.fault_injector = nullptr;
  probe.progress = {};
  probe.checkpoint = nullptr;
  return render_frame(probe, provide(probe, 0), whole, cut).visits;
}

}  // namespace kdray::odprt
