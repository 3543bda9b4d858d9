#include "device/opencl/spare_queue.h"

#include <map>
#include <mutex>
#include <utility>

#include "device/opencl/opencl_error.h"

namespace kdray::device {

namespace {

// Contexts are never destroyed (context.h), so their addresses name them. Neither are these, on purpose.
struct Spares {
  std::mutex mutex;
  std::map<std::pair<cl_context, std::size_t>, std::vector<cl::CommandQueue>> of;
};
Spares& spares() {
  static auto* all = new Spares;
  return *all;
}

}  // namespace

SpareQueue::SpareQueue(const Context& context, std::size_t sub_device) {
  Spares& all = spares();
  const std::lock_guard lock(all.mutex);
  free_ = &all.of[{context.get()(), sub_device}];
  if (free_->empty()) {
    queue_ = checked("opening a queue", [&] {
      return cl::CommandQueue(context.get(), context.opened().devices.at(sub_device), 0);
    });
  } else {
    queue_ = free_->back();
    free_->pop_back();
  }
}

SpareQueue::~SpareQueue() {
  const std::lock_guard lock(spares().mutex);
  free_->push_back(queue_);
}

}  // namespace kdray::device
