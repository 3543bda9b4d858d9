// What    An array that the host and a device's kernels both use, kept from one launch to the next: the same
//         memory where the device works in the host's, else one on each side.
// Shape   What the host has written goes to kernels by send(), what kernels have written comes back by
//         fetch() when they have ended; both do nothing where the memory is the same.
// Errors  ErrorCode::out_of_memory; device errors as everywhere.
#pragma once

#include <algorithm>
#include <span>

#include "base/memory.h"
#include "device/opencl/buffers.h"
#include "device/opencl/context.h"

namespace kdray::query {

template <class T>
class DeviceArray {
 public:
  DeviceArray() = default;
  DeviceArray(const device::Context& context, cl_mem_flags flags, std::size_t n, const char* what)
      : in_place_(context.works_in_host_memory()), host_(std::max<std::size_t>(n, 1)) {
    buffer_ = in_place_
                  ? device::buffer_over(context.get(), flags, host_.data(), host_.bytes(), host_.owner())
                  : context.buffer(flags, host_.bytes(), what);
  }

  std::size_t size() const { return host_.size(); }
  bool is_in_place() const { return in_place_; }
  T* data() { return host_.data(); }
  std::span<const T> first(std::size_t n) const { return {host_.data(), n}; }
  const cl::Buffer& buffer() const { return buffer_; }

  void send(cl::CommandQueue& queue, std::size_t n) {
    if (!in_place_ && n > 0) queue.enqueueWriteBuffer(buffer_, CL_TRUE, 0, n * sizeof(T), host_.data());
  }
  void fetch(cl::CommandQueue& queue, std::size_t n) {
    if (!in_place_ && n > 0) queue.enqueueReadBuffer(buffer_, CL_TRUE, 0, n * sizeof(T), host_.data());
  }

 private:
  bool in_place_ = false;
  Array<T> host_;
  cl::Buffer buffer_;
};

}  // namespace kdray::query
