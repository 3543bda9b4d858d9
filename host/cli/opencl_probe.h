// What    What OpenCL's loader sees on this machine, step by step: the drivers that are registered,
//         whether they can be opened, the platforms they give, the devices those have. `kdray doctor`
//         explains each step that fails.
// Source  The loader is ocl-icd or Khronos': *.icd files in /etc/OpenCL/vendors, or where OCL_ICD_VENDORS
//         points: another folder, a single .icd file, or a library.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kdray::cli {

struct Driver {
  std::string file;     // /etc/OpenCL/vendors/pocl.icd, or OCL_ICD_VENDORS
  std::string library;  // its first line: libpocl.so.2; empty when unreadable
  bool opens = false;
  std::string why_not;  // the dynamic linker's words
};

struct Platform {
  std::string name, version;
  std::uint32_t devices = 0;
};

struct Variable {
  std::string name, value;
};

std::string vendors_folder();        // where *.icd files are looked for
std::vector<Driver> find_drivers();  // sorted by file name
std::vector<Platform> find_platforms();
std::vector<Variable> opencl_environment();  // OCL_*, POCL_* and CUDA_VISIBLE_DEVICES, as far as set

}  // namespace kdray::cli
