// What    What kdray tells of an OpenCL device.
#pragma once

#include <cstdint>
#include <string>

namespace kdray {

struct DeviceInfo {
  int number = 0;
  std::string name, platform, version, driver, kind;  // kind: "cpu", "gpu", "accelerator"
  std::uint32_t compute_units = 0;
  std::uint64_t global_memory = 0, max_allocation = 0;
  std::string vectors;  // the form of the kernels' vector operations: "x86 AVX-512", "x86 AVX2" or "portable"
  std::string
      vectors_refused;  // the better forms that can't be had, each with why; empty where there is none
  bool double_precision = false;
  bool usable = true;
  std::string why_not;  // when not usable
};

}  // namespace kdray
