// What    One stage of the wavefront: a kernel with its arguments, launched on a queue, timed by the device's
//         clock.
#pragma once

#include <deque>
#include <string>

#include "device/opencl.h"

namespace kdray::wavefront {

class Stage {
 public:
  Stage(std::string name, cl::Kernel kernel) : name_(std::move(name)), kernel_(std::move(kernel)) {}

  const std::string& name() const { return name_; }
  cl::Kernel& kernel() { return kernel_; }

  // Sets the arguments from `index` on, in order.
  template <class... Arguments>
  void set_arguments(cl_uint index, const Arguments&... arguments) {
    (kernel_.setArg(index++, arguments), ...);
  }

  // Runs `items` work-items in groups of `local`; the launch is rounded up to whole groups (kernels check
  // their bound).
  cl::Event launch(cl::CommandQueue& queue, std::size_t items, std::size_t local);

  // Leaves the launches so far out of the time.
  void forget_launches() { launches_.clear(); }

  // Device time of all launches that have ended by now; never waits for one.
  double collect_seconds();

 private:
  std::string name_;
  cl::Kernel kernel_;
  std::deque<cl::Event> launches_;  // whose time is still to be added
  double seconds_ = 0;
};

}  // namespace kdray::wavefront
