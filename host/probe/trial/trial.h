// What    A trial: a driver is asked for its devices, a device takes the self-test, in a child process that
//         may crash or hang without harm; and the program that the child is: kdray itself, whose first
//         argument is then "--try".
// Shape   The child reports first that it has begun, then what came of it. What it leaves unsaid is read off
//         its end.
// Why     A program, and no fork() of this process: only its own copy of OpenCL's loader, with no thread that
//         a fork would have left behind and no lock that nobody gives back, shows what a driver does. A
//         program that uses kdray as a library has another main(), which can't be asked.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/child.h"
#include "base/hash.h"
#include "device/opencl/verdicts.h"

namespace kdray::trial {

// Tells that this program does trials itself, when its arguments ask for one.
void this_program_tries();

// Returns the program that trials are made with: this one, if it does trials; else the one that KDRAY_PROGRAM
// names; else `kdray` beside the running program, where it was installed, or in PATH. Empty: there is none.
std::optional<std::filesystem::path> program();

enum class Subject {
  driver,  // lists the devices of all drivers that it sees
  device,  // the self-test of the device whose verdict lies under the key
  picture  // the picture and the rays that `kdray doctor` asks for of that device
};

// The outcome of a trial. No verdict: there is no program that tries, it is another kdray's, or what went
// wrong is not the driver's fault.
struct Outcome {
  std::optional<device::Verdict> verdict = {};
  bool lasting = true;  // false: somebody killed the child; the next trial may end otherwise
};

// Seconds that a trial may take. Compilers of GPUs may take half a minute for the self-test's kernels.
constexpr double kTrialSeconds = 15, kGpuTrialSeconds = 60;

// Returns what KDRAY_TRIAL_SECONDS says, else `usual`.
double time_limit(double usual = kTrialSeconds);

class Trial {
 public:
  // Starts the trial. The child sees these environment variables in place of its own.
  Trial(Subject subject, const Hash& key, const std::map<std::string, std::string>& environment = {},
        double usual_seconds = kTrialSeconds);

  const Outcome& outcome();  // waits for the end

 private:
  Subject subject_;
  double limit_seconds_;
  std::unique_ptr<Child> child_;  // null: there is no program that tries
  std::optional<Outcome> outcome_;
};

// Returns what a child's end means.
Outcome outcome_of(Subject subject, const ChildEnd& end, double limit_seconds);

// What the child of a trial does: `kdray --try driver|device|picture KEY PARENT`. The child reports in
// lines on Child::kReport: that it has begun; then a word for the outcome and more text, or that there is
// no verdict.
constexpr const char* kTry = "--try";
constexpr const char* kBegun = "begun 1";  // and the report's version
constexpr const char* kPassed = "passed ";
constexpr const char* kFailed = "failed ";
constexpr const char* kNone = "none ";

struct TrialRequest {
  Subject subject;
  std::string key;
  int parent;
};

// Returns the trial that a program's arguments ask for; nothing where they ask for none.
std::optional<TrialRequest> request_of(std::span<const char* const> arguments);

// Returns what is wrong with the picture of the device of this number; empty: nothing.
using TestPicture = std::function<std::string(int number)>;

// Does the trial and ends the process, without a clean-up: the outcome is reported, and a driver might hang
// in it.
[[noreturn]] void try_it(const TrialRequest& request, const TestPicture& test_picture);

}  // namespace kdray::trial
