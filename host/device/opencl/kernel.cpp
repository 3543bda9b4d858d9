#include "device/opencl/kernel.h"

#include <fmt/format.h>

#include <bit>
#include <cstddef>

#include "device/opencl/opencl_error.h"

namespace kdray::device {

namespace {

cl::Kernel make_kernel(const cl::Program& program, const char* name) {
  return checked(fmt::format("making the kernel {}", name), [&] { return cl::Kernel(program, name); });
}

}  // namespace

AnyKernel::AnyKernel(const cl::Program& program, const char* name, std::span<const char* const> parameters)
    : kernel_(make_kernel(program, name)),
      name_(name),
      parameters_(parameters),
      unset_(~std::uint64_t{0} >> (64 - parameters.size())) {
  const cl_uint takes =
      checked("asking a kernel for its arguments", [&] { return kernel_.getInfo<CL_KERNEL_NUM_ARGS>(); });
  if (takes != parameters.size())
    throw Error(ErrorCode::internal,
                fmt::format("the kernel {} takes {} arguments and its list has {}; this is a fault of kdray, "
                            "please report it",
                            name, takes, parameters.size()));
}

const cl::Kernel& AnyKernel::ready() const {
  if (unset_ != 0)
    throw Error(
        ErrorCode::internal,
        fmt::format("the kernel {} was to be launched without its argument {}; this is a fault of kdray, "
                    "please report it",
                    name_, parameters_[static_cast<std::size_t>(std::countr_zero(unset_))]));
  return kernel_;
}

}  // namespace kdray::device
