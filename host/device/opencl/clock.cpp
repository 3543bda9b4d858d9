#include "device/opencl/clock.h"

#include <limits>

namespace kdray::device {

namespace {

constexpr int kRounds = 8;

double host_seconds() {
  return std::chrono::duration<double>(Clock::Host::now().time_since_epoch()).count();
}

}  // namespace

cl_ulong profiled_nanoseconds(const cl::Event& event, cl_profiling_info moment) {
  event.wait();
  cl_ulong nanoseconds = 0;
  event.getProfilingInfo(moment, &nanoseconds);
  return nanoseconds;
}

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
    const auto start = static_cast<double>(profiled_nanoseconds(event, CL_PROFILING_COMMAND_START));
    const auto end = static_cast<double>(profiled_nanoseconds(event, CL_PROFILING_COMMAND_END));
    ahead_ = 0.5 * (before + after) - 0.5e-9 * (start + end);
  }
}

}  // namespace kdray::device
