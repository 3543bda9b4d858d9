#include "engine/wavefront/stage.h"

#include <algorithm>

#include "device/opencl/clock.h"

namespace kdray::wavefront {

cl::Event LaunchClock::launch(const cl::Kernel& kernel, cl::CommandQueue& queue, std::size_t items,
                              std::size_t local) {
  if (largest_group_ == 0)
    largest_group_ = kernel.getWorkGroupInfo<CL_KERNEL_WORK_GROUP_SIZE>(queue.getInfo<CL_QUEUE_DEVICE>());
  local = std::min(local, largest_group_);
  const std::size_t groups = (items + local - 1) / local;
  cl::Event event;
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups * local), cl::NDRange(local), nullptr,
                             &event);
  launches_.push_back(event);
  return event;
}

double LaunchClock::collect_seconds() {
  while (!launches_.empty() &&
         launches_.front().getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>() == CL_COMPLETE) {
    const cl::Event& event = launches_.front();
    seconds_ += 1e-9 * static_cast<double>(device::profiled_nanoseconds(event, CL_PROFILING_COMMAND_END) -
                                           device::profiled_nanoseconds(event, CL_PROFILING_COMMAND_START));
    launches_.pop_front();
  }
  return seconds_;
}

}  // namespace kdray::wavefront
