// What    A queue's profiling times on the host's clock, so that what several devices did can be shown side
//         by side.
// Shape   The difference of the two clocks, from the shortest of a few commands: what lies between asking for
//         it and its end bounds the error. Clocks that run apart afterwards (about 1e-4) are not followed.
#pragma once

#include <chrono>

#include "device/opencl/opencl.h"

namespace kdray::device {

class Clock {
 public:
  using Host = std::chrono::steady_clock;

  // `queue` has profiling switched on, and nothing to do. Throws cl::Error.
  Clock(const cl::Context& context, cl::CommandQueue queue);

  // `seconds` of a command's profiling times.
  Host::time_point on_host(double seconds) const {
    return Host::time_point(
        std::chrono::duration_cast<Host::duration>(std::chrono::duration<double>(seconds + ahead_)));
  }

 private:
  double ahead_ = 0;  // host's seconds - device's
};

}  // namespace kdray::device
