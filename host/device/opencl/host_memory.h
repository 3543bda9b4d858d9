// What    Buffers for a device that works in the host's memory (CL_DEVICE_HOST_UNIFIED_MEMORY): a buffer uses
//         kdray's memory in place, and keeps it as long as the buffer lives.
// Errors  cl::Error and std::bad_alloc.
#pragma once

#include <cstddef>
#include <memory>

#include "device/opencl/opencl.h"

namespace kdray::device {

// Returns a buffer over `bytes` > 0 at `memory`, which `owner` keeps alive.
cl::Buffer buffer_over(const cl::Context& context, cl_mem_flags flags, const void* memory, std::size_t bytes,
                       std::shared_ptr<void> owner);

}  // namespace kdray::device
