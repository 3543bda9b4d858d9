// What    PDPRT: renders a frame with its pixels divided among the context's queues, each of which sees the whole scene.
// Source  T. V. Christensen, "Parallel Ray Tracing", DTU 2009: pixel-distributed, bag of tasks.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "film/image.h"
#include "wavefront/wavefront.h"

namespace kdray::pdprt {

struct Result {
  film::Image image;
  wavefront::Counters counters;
  std::map<std::string, double> stage_seconds;  // device time, added over the queues
  double render_seconds = 0;                    // wall time from the first launch to the finished film
  std::size_t device_bytes = 0;                 // of all queues, without the scene
  std::uint32_t n_bands = 0;
};

// `frame` comes without a schedule (flatten::make_frame); `progress` is called from this thread with the share done.
Result render(const device::Context& context, const wavefront::SceneBuffers& scene,
              wavefront::Programs& programs, layout::Frame frame, const wavefront::Schedule& schedule,
              std::uint32_t features, const std::function<void(double)>& progress);

}  // namespace kdray::pdprt
