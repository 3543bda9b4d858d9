// What    Builds a program of which there may be variants (variant.h): the one that was asked for where the
//         cache has it, else one there that covers it, else anew.
// Shape   What is compiled anew is for just what is wanted, until a few programs of its family are there that
//         don't do: then it is for everything, and nothing of the family is compiled again.
// Errors  As building (program.h): ErrorCode::no_device where the compiler refuses the program.
#pragma once

#include "device/opencl/builds.h"
#include "device/opencl/opencl.h"
#include "device/opencl/variant.h"

namespace kdray::device {

struct BuiltVariant {
  cl::Program program;
  std::uint64_t mask = 0;  // that it was built with
  bool compiled = false;   // just now
};

BuiltVariant build_variant(const cl::Context& context, const std::vector<cl::Device>& devices,
                           const std::string& file, const Variant& wanted, const Builds& builds);

}  // namespace kdray::device
