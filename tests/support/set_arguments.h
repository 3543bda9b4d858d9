// What    Sets the arguments of a test's own kernel, all of them, in the order of its parameters. kdray's
//         kernels have their arguments by name (device/opencl/kernel.h).
// Errors  Throws where the kernel takes another number of them.
#pragma once

#include <stdexcept>

#include "device/opencl/opencl.h"

namespace kdray::test {

template <class... Values>
void set_arguments(cl::Kernel& kernel, const Values&... values) {
  if (kernel.getInfo<CL_KERNEL_NUM_ARGS>() != sizeof...(values))
    throw std::logic_error("a test's kernel is given too many arguments, or too few");
  cl_uint place = 0;
  (kernel.setArg(place++, values), ...);
}

}  // namespace kdray::test
