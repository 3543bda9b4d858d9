// What    The stages of ODPRT's waves where every ray has a work-item (kernels/odprt/stages): a launch for
//         each stage of each wave.
// Shape   The rays of a queue are one slice's.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "device/opencl/kernel.h"
#include "engine/odprt/outbox.h"
#include "engine/wavefront/programs.h"
#include "engine/wavefront/stage.h"
#include "layout/frame.layout.h"

namespace kdray::odprt {

class RayStages {
 public:
  // Builds the programs, for features with numbers; `work_group` is the local size of all launches.
  RayStages(wavefront::Programs& programs, layout::Features features, std::size_t work_group);

  // Calls `act` with every stage that is there.
  template <class Do>
  void for_each(const Do& act) {
    act(plan_), act(admit_), act(trace_), act(shade_), act(receive_);
    if (shadow_) act(*shadow_);
  }

  // Launches waves of a frame's batch size, whose shadow rays come in rounds of its light batch. What they
  // send goes into the outbox.
  void launch(cl::CommandQueue& queue, const layout::Frame& frame, std::uint32_t n_waves,
              std::uint32_t n_tiles, const Outbox& outbox);
  // Launches what takes the rays of a place of an outbox, whose counts have been read.
  void receive(cl::CommandQueue& queue, const Outbox& outbox, std::uint32_t place);

  // The device's seconds so far, by the names that the stages of slices have.
  std::map<std::string, double> seconds();

 private:
  void launch_lights(cl::CommandQueue& queue, const layout::Frame& frame);

  const std::size_t work_group_;
  wavefront::Stage<kernels::TravelPlan> plan_;
  wavefront::Stage<kernels::TravelAdmit> admit_;
  wavefront::Stage<kernels::TravelTrace> trace_;
  wavefront::Stage<kernels::TravelShade> shade_;
  std::optional<wavefront::Stage<kernels::TravelShadow>> shadow_;  // in scenes with lights
  wavefront::Stage<kernels::TravelReceive> receive_;
};

}  // namespace kdray::odprt
