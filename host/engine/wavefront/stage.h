// What    One stage of the wavefront: a kernel with its arguments, launched on a queue, timed by the device's
//         clock.
#pragma once

#include <deque>

#include "device/opencl/kernel.h"
#include "device/opencl/opencl.h"

namespace kdray::wavefront {

// The device time of a kernel's launches.
class LaunchClock {
 public:
  // Leaves the launches so far out of the time.
  void forget_launches() { launches_.clear(); }

  // Device time of all launches that have ended by now; never waits for one.
  double collect_seconds();

 protected:
  cl::Event launch(const cl::Kernel& kernel, cl::CommandQueue& queue, std::size_t items, std::size_t local);

 private:
  std::deque<cl::Event> launches_;  // whose time is still to be added
  double seconds_ = 0;
  std::size_t largest_group_ = 0;  // that the kernel can be launched in; 0: not asked yet
};

// The kernel that K describes (device/opencl/kernel.h).
template <class K>
class Stage : public LaunchClock {
 public:
  explicit Stage(device::Kernel<K> kernel) : kernel_(std::move(kernel)) {}

  static constexpr const char* name() { return K::kFunction; }

  template <class Argument, class Value>
  Stage& set(Argument argument, const Value& value) {
    kernel_.set(argument, value);
    return *this;
  }

  // Runs `items` work-items in groups of `local`, or of as many as the kernel can have; the launch is rounded
  // up to whole groups (kernels check their bound).
  cl::Event launch(cl::CommandQueue& queue, std::size_t items, std::size_t local) {
    return LaunchClock::launch(kernel_.ready(), queue, items, local);
  }

 private:
  device::Kernel<K> kernel_;
};

}  // namespace kdray::wavefront
