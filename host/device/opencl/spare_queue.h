// What    A command queue for one thread at a time, beside those that frames use: for queries that several
//         threads ask at once.
// Why     PoCL 3.1 crashes when a queue is released right after its last command (context.h): so queues are
//         kept, and given to the next caller.
#pragma once

#include <cstddef>
#include <vector>

#include "device/opencl/context.h"
#include "device/opencl/opencl.h"

namespace kdray::device {

class SpareQueue {
 public:
  // Takes or opens a queue on one of the context's devices, given by its index.
  explicit SpareQueue(const Context& context, std::size_t sub_device = 0);
  ~SpareQueue();
  SpareQueue(const SpareQueue&) = delete;
  SpareQueue& operator=(const SpareQueue&) = delete;

  cl::CommandQueue& get() { return queue_; }

 private:
  std::vector<cl::CommandQueue>* free_;  // where it goes back to
  cl::CommandQueue queue_;
};

}  // namespace kdray::device
