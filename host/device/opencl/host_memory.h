// What    Buffers of a device that works in the host's memory (CL_DEVICE_HOST_UNIFIED_MEMORY): memory of
//         ours, used as it is, which the buffer keeps as long as it lives.
// Errors  cl::Error and std::bad_alloc.
#pragma once

#include <cstddef>
#include <memory>

#include "device/opencl/opencl.h"

namespace kdray::device {

// `bytes` > 0 at `memory`, which `owner` keeps there.
cl::Buffer buffer_over(const cl::Context& context, cl_mem_flags flags, const void* memory, std::size_t bytes,
                       std::shared_ptr<void> owner);

}  // namespace kdray::device
