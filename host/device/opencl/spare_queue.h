// What    A command queue for one thread at a time, beside those that frames use: for queries that several
//         threads ask at once.
// Why     PoCL 3.1 crashes when a queue is released right after its last command (context.h): queues are kept
//         and given to the next who asks.
#pragma once

#include "device/opencl/context.h"
#include "device/opencl/opencl.h"

namespace kdray::device {

class SpareQueue {
 public:
  // On the context's first device.
  explicit SpareQueue(const Context& context);
  ~SpareQueue();
  SpareQueue(const SpareQueue&) = delete;
  SpareQueue& operator=(const SpareQueue&) = delete;

  cl::CommandQueue& get() { return queue_; }

 private:
  cl_context context_;
  cl::CommandQueue queue_;
};

}  // namespace kdray::device
