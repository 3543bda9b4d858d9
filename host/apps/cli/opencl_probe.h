// What    What OpenCL's loader sees on this machine, step by step: whether the drivers that are registered
//         (trial/drivers.h) can be opened, the platforms they give, the devices those have. `kdray doctor`
//         explains each step that fails.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kdray::cli {

struct Platform {
  std::string name, version;
  std::uint32_t devices = 0;
};

struct Variable {
  std::string name, value;
};

// Why the dynamic linker can't open this library, in its words; empty: it can.
std::string why_not_opened(const std::string& library);

std::vector<Platform> find_platforms();
std::vector<Variable> opencl_environment();  // OCL_*, POCL_* and CUDA_VISIBLE_DEVICES, as far as set

}  // namespace kdray::cli
