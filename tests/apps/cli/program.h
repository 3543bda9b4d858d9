// What    Runs the built kdray as a user would, in a process of its own, and tells what came of it.
// Shape   No shell is involved. A run that outlasts kPatience is killed, and then neither exited nor has a
//         code.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace kdray::test {

struct Outcome {
  bool exited = false;  // false: killed, by a signal of its own or since it hung
  int code = -1;
  int signal = 0;
  std::string out, err;
  double seconds = 0;
  long peak_kib = 0;  // the largest resident set
};

struct RunOptions {
  std::filesystem::path program = {};                   // empty: the built kdray
  std::filesystem::path folder = {};                    // to run in; empty: where the test runs
  std::map<std::string, std::string> environment = {};  // set on top of the test's own
  std::filesystem::path stdin_file = {};                // empty: nothing
  std::filesystem::path stdout_file = {};               // instead of Outcome::out
  std::size_t limit_address_space = 0;                  // bytes; 0: none
  int signal = 0;                                       // sent as soon as `signal_when` says so; 0: none
  std::function<bool()> signal_when = {};
};

Outcome kdray(const std::vector<std::string>& arguments, const RunOptions& options = {});

// What is on stderr without the notice of compiling, which a busy machine may or may not bring out.
std::string without_notice(std::string err);

// The run failed as the command line promises: this code, nothing on stdout, one line "kdray: ..." with
// `text` in it.
::testing::AssertionResult fails_with(const Outcome& run, int code, const std::string& text);

// The run ended with 0; says what it printed otherwise.
::testing::AssertionResult succeeds(const Outcome& run);

bool has_device();

// Whether kdray-bench was built, without which `kdray bench` only says that it is missing.
bool has_bench();

}  // namespace kdray::test

#define KDRAY_NEED_DEVICE() \
  if (!kdray::test::has_device()) GTEST_SKIP() << "no usable OpenCL device"
