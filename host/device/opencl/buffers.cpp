#include "device/opencl/buffers.h"

#include <algorithm>
#include <exception>

namespace kdray::device {

std::optional<cl::Buffer> KeptBuffers::take(std::size_t wanted) {
  const std::size_t bytes = std::max(wanted, kLeastBufferBytes);
  if (bytes > most_) return std::nullopt;  // such are never left
  const std::lock_guard lock(mutex_);
  const auto place = by_size_.find(bytes);
  if (place == by_size_.end()) {
    by_size_.clear();
    bytes_ = 0;
    return std::nullopt;
  }
  cl::Buffer buffer = place->second;
  by_size_.erase(place);
  bytes_ -= bytes;
  return buffer;
}

void KeptBuffers::leave(const cl::Buffer& buffer) noexcept {
  if (!buffer()) return;
  const std::lock_guard lock(mutex_);
  try {
    const std::size_t bytes = buffer.getInfo<CL_MEM_SIZE>();
    if (bytes > most_ - bytes_) return;
    by_size_.emplace(bytes, buffer);
    bytes_ += bytes;
  } catch (const std::exception&) {  // then it is made again
  }
}

void KeptBuffers::clear() {
  const std::lock_guard lock(mutex_);
  by_size_.clear();
  bytes_ = 0;
}

std::size_t KeptBuffers::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

namespace {

using Owner = std::shared_ptr<void>;

void CL_CALLBACK release(cl_mem, void* owner) {
  delete static_cast<Owner*>(owner);
}

}  // namespace

cl::Buffer buffer_over(const cl::Context& context, cl_mem_flags flags, const void* memory, std::size_t bytes,
                       std::shared_ptr<void> owner) {
  auto kept = std::make_unique<Owner>(std::move(owner));
  // OpenCL takes no pointer to const, even for what kernels only read.
  cl::Buffer buffer(context, flags | CL_MEM_USE_HOST_PTR, bytes, const_cast<void*>(memory));
  buffer.setDestructorCallback(release, kept.get());
  kept.release();
  return buffer;
}

}  // namespace kdray::device
