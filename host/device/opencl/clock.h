// What    Converts a queue's profiling times to the host's clock, so that what several devices did can be
//         shown side by side.
// Shape   The difference of the two clocks is measured at the shortest of a few commands: the time between
//         enqueueing it and its end bounds the error. Drift of the clocks afterwards (about 1e-4) is not
//         corrected.
#pragma once

#include <chrono>

#include "device/opencl/opencl.h"

namespace kdray::device {

// Returns when a command got to `moment` (CL_PROFILING_COMMAND_START or _END), in nanoseconds of the device's
// clock. Waits for its end: that a later command of its queue has ended, or that a blocking call has
// returned, is not enough for NVIDIA's driver and Intel's runtime. Throws cl::Error.
cl_ulong profiled_nanoseconds(const cl::Event& event, cl_profiling_info moment);

class Clock {
 public:
  using Host = std::chrono::steady_clock;

  // `queue` has profiling switched on, and nothing to do. Throws cl::Error.
  Clock(const cl::Context& context, cl::CommandQueue queue);

  // Converts `seconds` of a command's profiling times.
  Host::time_point on_host(double seconds) const {
    return Host::time_point(
        std::chrono::duration_cast<Host::duration>(std::chrono::duration<double>(seconds + ahead_)));
  }

 private:
  double ahead_ = 0;  // host's seconds - device's
};

}  // namespace kdray::device
