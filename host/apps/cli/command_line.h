// What    What kdray and kdray-bench have in common as programs: they turn the command line into a command,
//         and what is thrown into an exit code.
// Errors  0 done, 1 input, 2 usage, 3 no device, 4 out of memory (docs/cli.md); always one line on stderr.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <span>

#include "apps/cli/command.h"

namespace kdray::cli {

// Sets what help says of all commands. To be called before a command is added, since commands inherit it.
void prepare(CLI::App& app);

// The first argument is the program's name. Prints help and version where they are asked for.
int parse_and_run(CLI::App& app, std::span<const char* const> arguments, std::span<const Command> commands);

// Runs it and returns what main() is to return.
int run_program(const std::function<int()>& run);

}  // namespace kdray::cli
