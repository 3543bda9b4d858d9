#include "device/opencl/clock.h"

#include <limits>

namespace kdray::device {

namespace {

constexpr int kRounds = 8;

double host_seconds() {
  return std::chrono::duration<double>(Clock::Host::now().time_since_epoch()).count();
}

}  // namespace

Clock::Clock(const cl::Context& context, cl::CommandQueue queue) {
  const cl::Buffer buffer(context, CL_MEM_READ_WRITE, 16);
  const cl_uint word = 0;
  double shortest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kRounds; ++i) {
    cl::Event event;
    const double before = host_seconds();
    queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, sizeof word, &word, nullptr, &event);
    const double after = host_seconds();
    if (after - before >= shortest) continue;
    shortest = after - before;
    event.wait();  // a blocking call may end before its event is complete and has times (Intel's runtime)
    const auto start = event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
    const auto end = event.getProfilingInfo<CL_PROFILING_COMMAND_END>();
    const double middle = 0.5e-9 * (static_cast<double>(start) + static_cast<double>(end));
    ahead_ = 0.5 * (before + after) - middle;
  }
}

}  // namespace kdray::device
