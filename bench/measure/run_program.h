// What    Runs a program of another's and waits for its end: POV-Ray, the script that draws plots.
// Shape   It reads nothing, and what it prints to stdout is lost; stderr goes to `log`, or where this
//         program's goes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kdray::bench {

inline constexpr int kNotRun = -1;

// The first argument is the program, looked for in PATH. Returns its exit code; kNotRun: it can't be started,
// or a signal has ended it.
int run_program(std::vector<std::string> arguments, const std::filesystem::path& log = {});

}  // namespace kdray::bench
