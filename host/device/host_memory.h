// What    Memory of the host that a CPU device uses as it is: large pages where the system gives them, freed with the buffer.
// Why     A walk through a tree touches memory all over; with pages of 4 KiB it waits for address translation at each node
//
//         (measured: a fifth of a packet walk was spent at its prefetches, which wait for it too).
#pragma once

#include <cstddef>

#include "device/opencl.h"

namespace kdray::device {

// From this size on a buffer gains by it.
inline constexpr std::size_t kLargePages = std::size_t{4} << 20;

// A buffer of a device that works in the host's memory (CL_DEVICE_HOST_UNIFIED_MEMORY). Throws cl::Error and std::bad_alloc.
cl::Buffer host_buffer(const cl::Context& context, cl_mem_flags flags, std::size_t bytes);

}  // namespace kdray::device
