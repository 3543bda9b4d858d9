// What    A trial: a driver is asked for its devices, a device takes the self-test, in a child process that
//         may crash or hang without harm.
// Shape   The child reports first that it has begun, then what came of it (request.h). What it leaves unsaid
//         is read off its end.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "base/child.h"
#include "base/hash.h"
#include "device/opencl/verdicts.h"

namespace kdray::trial {

enum class Subject {
  driver,  // lists the devices of all drivers that it sees
  device,  // the self-test of the device whose verdict lies under the key
  picture  // the picture and the rays that `kdray doctor` asks for of that device
};

// What came of it. No verdict: there is no program that tries, it is another kdray's, or what went wrong is
// none of the driver's doing.
struct Outcome {
  std::optional<device::Verdict> verdict = {};
  bool lasting = true;  // false: somebody killed the child; the next trial may end otherwise
};

// The seconds that a trial may take: 15, or what KDRAY_TRIAL_SECONDS says.
double time_limit();

class Trial {
 public:
  // Starts it. The child sees these environment variables in place of its own.
  Trial(Subject subject, const Hash& key, const std::map<std::string, std::string>& environment = {});

  const Outcome& outcome();  // waits for it

 private:
  Subject subject_;
  double limit_seconds_;
  std::unique_ptr<Child> child_;  // null: there is no program that tries
  std::optional<Outcome> outcome_;
};

// What a child's end says.
Outcome outcome_of(Subject subject, const ChildEnd& end, double limit_seconds);

}  // namespace kdray::trial
