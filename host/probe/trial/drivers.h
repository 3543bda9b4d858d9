// What    The OpenCL drivers that are registered on this machine, as files tell before any of them is loaded;
//         and which of them are left out, since they hang or crash as soon as they are asked for their
//         devices: OpenCL's loader asks every driver that is registered, so one of them would take all the
//         others along.
// Shape   Each driver without a verdict lists its devices in a child process, all of them at once; then the
//         loader is shown those that came through, by OCL_ICD_VENDORS and a folder of their .icd files. A
//         driver that is the only one is asked in this process, under a mark (device/opencl/verdicts.h):
//         there is nothing else to fall back on, and the usual case is as fast as without all this. Where a
//         mark was left behind it goes to a child, too.
// Errors  ErrorCode::no_device: a driver has to be left out, and that folder can't be made.
// Threads The first call of mind_drivers() sets an environment variable where a driver is left out, and comes
//         before OpenCL's first call.
// Source  The loader is ocl-icd or Khronos': *.icd files in /etc/OpenCL/vendors, or where OCL_ICD_VENDORS
//         points: another folder, a single .icd file, or a library.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/hash.h"
#include "device/opencl/verdicts.h"

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

// Returns the key that a driver's verdict is kept under. It is made of the driver's files, of what the
// dynamic linker knows, and of the variables that switch drivers on.
Hash key_of(const Driver& driver);

struct DriverVerdict {
  Driver driver;
  device::Verdict verdict;
  bool left_out = false;

  std::string in_words() const;  // of a driver that failed, with what can be done about it
};

struct ListingOptions {
  device::Verdicts verdicts = device::Verdicts();
  // The names that the user asked for, as in DeviceOptions::device: a driver stays where one is part of its
  // name.
  std::string insisted = {};
  std::function<void(bool)> watch = {};  // told true when children begin, false when they have ended
  bool anew = false;                     // each driver is tried in a child, whatever is known of it
};

// Returns what is known of the drivers, in the order of registered_drivers(). The first call in a process
// tries them where needed, and decides which are left out.
const std::vector<DriverVerdict>& mind_drivers(const ListingOptions& options);

}  // namespace kdray::trial
