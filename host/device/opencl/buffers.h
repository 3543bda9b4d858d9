// What    Buffers that a frame leaves to the next one of its size: making them, and first touching their
//         pages, takes up to a millisecond, which is a third of a small frame.
// Shape   One store for each Context and its copies. A buffer belongs to its taker until it is left again;
//         its contents are undefined.
// Threads Any.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "device/opencl/opencl.h"

namespace kdray::device {

// OpenCL has no empty buffers.
inline constexpr std::size_t kLeastBufferBytes = 16;

class KeptBuffers {
 public:
  // `most`: bytes that are kept in all.
  explicit KeptBuffers(std::size_t most) : most_(most) {}

  // Returns a buffer of CL_MEM_READ_WRITE that has just `bytes` (or kLeastBufferBytes). Where none was left,
  // all others go: frames have another size from now on.
  std::optional<cl::Buffer> take(std::size_t bytes);

  // No command may use the buffer any more. A null one, or one too large, isn't kept.
  void leave(const cl::Buffer& buffer) noexcept;

  void clear();
  std::size_t bytes() const;

 private:
  const std::size_t most_;
  mutable std::mutex mutex_;
  std::multimap<std::size_t, cl::Buffer> by_size_;
  std::size_t bytes_ = 0;
};

// Buffers for a device that works in the host's memory (CL_DEVICE_HOST_UNIFIED_MEMORY): a buffer uses
// kdray's memory in place, and keeps it as long as the buffer lives. Errors: cl::Error and std::bad_alloc.
//
// Returns a buffer over `bytes` > 0 at `memory`, which `owner` keeps alive.
cl::Buffer buffer_over(const cl::Context& context, cl_mem_flags flags, const void* memory, std::size_t bytes,
                       std::shared_ptr<void> owner);

}  // namespace kdray::device
