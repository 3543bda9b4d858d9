// What    What the child of a trial does: `kdray --try driver|device|picture KEY PARENT`.
// Shape   It reports on Child::kReport, a line each: that it has begun; then the word for what came of it and
//         more text, or that it came to no verdict.
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

// What a program's arguments ask for; nothing where they ask for no trial.
std::optional<TrialRequest> request_of(std::span<const char* const> arguments);

// Tells what is wrong with the picture of the device of this number; empty: nothing.
using TestPicture = std::function<std::string(int number)>;

// Does it and ends the process, without a clean-up: a driver that hangs there has been tried already.
[[noreturn]] void try_it(const TrialRequest& request, const TestPicture& test_picture);

}  // namespace kdray::trial
