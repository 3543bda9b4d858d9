#include "device/opencl/spare_queue.h"

#include <map>
#include <mutex>
#include <vector>

#include "device/opencl/opencl_error.h"

namespace kdray::device {

namespace {

// Contexts are never destroyed (context.h), so their addresses name them. Neither are these, on purpose.
struct Spares {
  std::mutex mutex;
  std::map<cl_context, std::vector<cl::CommandQueue>> of;
};
Spares& spares() {
  static auto* all = new Spares;
  return *all;
}

}  // namespace

SpareQueue::SpareQueue(const Context& context) : context_(context.get()()) {
  Spares& all = spares();
  const std::lock_guard lock(all.mutex);
  std::vector<cl::CommandQueue>& free = all.of[context_];
  if (free.empty()) {
    queue_ = checked("opening a queue",
                     [&] { return cl::CommandQueue(context.get(), context.opened().devices.front(), 0); });
  } else {
    queue_ = free.back();
    free.pop_back();
  }
}

SpareQueue::~SpareQueue() {
  Spares& all = spares();
  const std::lock_guard lock(all.mutex);
  all.of[context_].push_back(queue_);
}

}  // namespace kdray::device
