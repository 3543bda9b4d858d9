// What    The OpenCL drivers that are registered on this machine, as files tell, before any of them is
//         loaded.
// Source  The loader is ocl-icd or Khronos': *.icd files in /etc/OpenCL/vendors, or where OCL_ICD_VENDORS
//         points: another folder, a single .icd file, or a library.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/hash.h"

namespace kdray::trial {

struct Driver {
  std::filesystem::path file;  // /etc/OpenCL/vendors/pocl.icd; a library that OCL_ICD_VENDORS names itself
  std::string library;         // its first line: libpocl.so.2; empty when unreadable
  std::string unreadable;      // why
  bool is_library = false;     // the file is no .icd file, but the library

  std::string name() const;   // "libpocl.so.2 (pocl.icd)"
  std::string where() const;  // what registers it: the file, or OCL_ICD_VENDORS
};

std::filesystem::path vendors_folder();    // where *.icd files are looked for
std::vector<Driver> registered_drivers();  // sorted by file name

// The key that a driver's verdict is kept under: of its files, of what the dynamic linker knows, and of the
// variables that switch drivers on.
Hash key_of(const Driver& driver);

}  // namespace kdray::trial
