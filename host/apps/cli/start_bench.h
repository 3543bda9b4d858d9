// What    `kdray bench` is a program of its own, kdray-bench, which lies beside kdray: those who only
//         render need not carry what only measures.
// Shape   kdray becomes that program: the process stays, and with it its standard streams, the signals sent
//         to it and the exit status.
// Errors  ErrorCode::input where there is no such program or where it can't be run.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/cli/command.h"

namespace kdray::cli {

// For the list of commands in kdray's help.
Command add_bench(CLI::App& kdray);

// What    follows "bench" in kdray's arguments, of which the first is the program's name; none where
//         another command is asked for.
std::optional<std::vector<std::string>> arguments_of_bench(std::span<const char* const> arguments);

[[noreturn]] void start_bench(const std::vector<std::string>& arguments);

}  // namespace kdray::cli
