#include "device/opencl/host_memory.h"

namespace kdray::device {

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
