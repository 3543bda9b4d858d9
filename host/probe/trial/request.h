// What    What the child of a trial does: `kdray --try driver|device|picture KEY PARENT`.
// Shape   The child reports in lines on Child::kReport: that it has begun; then a word for the outcome and
//         more text, or that there is no verdict.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "probe/trial/trial.h"

namespace kdray::trial {

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
