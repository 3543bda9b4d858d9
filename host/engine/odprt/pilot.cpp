#include "engine/odprt/pilot.h"

#include "engine/odprt/frame.h"

namespace kdray::odprt {

namespace {

constexpr std::uint32_t kShrink = 8;  // pixels of the frame to one of the pilot's, along each side
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

std::vector<SubtreeUse> run_pilot(const Request& request, const Division& whole, const Cut& cut) {
  Request pilot = request;
  pilot.queues.resize(1);
  pilot.table = alone(1);
  pilot.n_slices = (request.n_slices + 3) / 4;  // its tiles are few
  pilot.frame = small_frame(request.frame);
  pilot.adaptive_target = 0;
  pilot.census_every = 1;
  pilot.device_memory = 0;
  pilot.timeline = nullptr;
  pilot.faults = nullptr;
  pilot.progress = {};
  pilot.ledger = nullptr;
  return render_frame(pilot, provide(pilot, 0), whole, cut).visits;
}

}  // namespace kdray::odprt
