// What    Leaves out drivers that hang or crash as soon as they are asked for their devices: OpenCL's loader
//         asks every driver that is registered, so one of them would take all the others along.
// Shape   Each driver without a verdict lists its devices in a child process, all of them at once; then the
//         loader is shown those that came through, by OCL_ICD_VENDORS and a folder of their .icd files. A
//         driver that is the only one is asked in this process, under a mark (device/verdicts.h): there is
//         nothing else to fall back on, and the usual case is as fast as without all this. Where a mark was
//         left behind it goes to a child, too.
// Errors  ErrorCode::no_device: a driver has to be left out, and that folder can't be made.
// Threads The first call sets an environment variable where a driver is left out, and comes before OpenCL's
//         first.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "device/opencl/verdicts.h"
#include "probe/trial/drivers.h"

namespace kdray::trial {

struct DriverVerdict {
  Driver driver;
  device::Verdict verdict;
  bool left_out = false;

  std::string in_words() const;  // of one that failed: with what can be done about it
};

struct ListingOptions {
  device::Verdicts verdicts = device::Verdicts();
  // What the user wants by name, as DeviceOptions::device: a driver stays where a name is part of its own.
  std::string insisted = {};
  std::function<void(bool)> watch = {};  // told true when children begin, false when they have ended
  bool anew = false;                     // each driver is tried in a child, whatever is known of it
};

// What is known of the drivers now, in registered_drivers()' order. The first call in a process decides which
// of them are left out.
const std::vector<DriverVerdict>& mind_drivers(const ListingOptions& options);

}  // namespace kdray::trial
