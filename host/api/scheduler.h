// What    How each device cuts a frame up: the size of tiles and batches, how many slices are in flight, how
//         much a launch does.
// Why     A choice changes time and memory, never the picture; what the last frame of this size told of its
//         tiles serves the next one.
// Errors  ErrorCode::usage for tiles that hold too many samples.
#pragma once

#include <cstdint>

#include "api/job.h"
#include "engine/device_scene/device_scene.h"
#include "engine/pdprt/tiles.h"
#include "engine/wavefront/wavefront.h"

namespace kdray::api {

class Scheduler {
 public:
  // `devices` have to outlive the scheduler. `n_ranks` processes share the frames.
  Scheduler(const engine::DeviceScene& devices, std::uint32_t n_ranks)
      : devices_(devices), n_ranks_(n_ranks) {}

  wavefront::Schedule schedule_for(const engine::Device& device, const Job& job) const {
    return schedule_for(device, job, !device.global);
  }
  // `fused`: of slices, whatever the device.
  wavefront::Schedule schedule_for(const engine::Device& device, const Job& job, bool fused) const;

  // What the tiles of a frame cost.
  void remember(const layout::Frame& frame, const pdprt::TileCost& cost);
  void forget() { last_ = {}; }

 private:
  void choose_tiles(wavefront::Schedule& schedule, const Job& job) const;
  std::uint32_t tile_side(const layout::Frame& frame) const;
  void choose_slices(wavefront::Schedule& schedule, const engine::Device& device) const;
  void choose_wave(wavefront::Schedule& schedule, const engine::Device& device, const Job& job) const;

  const engine::DeviceScene& devices_;
  std::uint32_t n_ranks_;
  struct {
    std::uint32_t width = 0, height = 0;
    pdprt::TileCost cost;
  } last_;
};

}  // namespace kdray::api
