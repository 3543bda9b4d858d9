// What    Runs a small test kernel over arrays: one work-item per element of `in`, which writes one element
//         of `out`.
// Shape   The source defines `__kernel void test(__global const IN* in, __global OUT* out, uint n)`.
#pragma once

#include <string>
#include <vector>

#include "device/opencl/context.h"
#include "device/opencl/opencl_error.h"
#include "support/set_arguments.h"

namespace kdray::test {

template <class Out, class In>
std::vector<Out> run_kernel(const std::string& device, const std::string& source, const std::vector<In>& in,
                            const std::string& options = "") {
  const device::Context context(device, 1);
  return device::checked("running a test kernel", [&] {
    // As kdray's own programs have it: without it NVIDIA's quotients and roots are approximations.
    const char* const rounded =
        context.rounds_division_correctly() ? "-cl-fp32-correctly-rounded-divide-sqrt " : "";
    cl::Kernel kernel(context.build_text("test.cl", source, "-cl-std=CL1.2 " + (rounded + options)), "test");
    const cl::Buffer in_buffer = context.buffer(CL_MEM_READ_ONLY, in.size() * sizeof(In), "in");
    const cl::Buffer out_buffer = context.buffer(CL_MEM_WRITE_ONLY, in.size() * sizeof(Out), "out");
    const cl::CommandQueue& queue = context.queues().front();
    queue.enqueueWriteBuffer(in_buffer, CL_TRUE, 0, in.size() * sizeof(In), in.data());
    set_arguments(kernel, in_buffer, out_buffer, static_cast<cl_uint>(in.size()));
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange((in.size() + 63) / 64 * 64),
                               cl::NDRange(64));
    std::vector<Out> out(in.size());
    queue.enqueueReadBuffer(out_buffer, CL_TRUE, 0, out.size() * sizeof(Out), out.data());
    return out;
  });
}

}  // namespace kdray::test
