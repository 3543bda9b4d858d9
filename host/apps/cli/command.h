// What    The commands: each adds its subcommand and options to the command line and says what to run
//         when it was chosen. One file per command.
// Errors  kdray::Error, which main.cpp turns into an exit code; `run` returns the exit code otherwise.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <vector>

namespace kdray::cli {

struct Command {
  CLI::App* app;
  std::function<int()> run;
};

Command add_render(CLI::App& kdray);
Command add_trace(CLI::App& kdray);
Command add_info(CLI::App& kdray);
Command add_devices(CLI::App& kdray);
Command add_doctor(CLI::App& kdray);
Command add_generate(CLI::App& kdray);
Command add_compare(CLI::App& kdray);
Command add_verify(CLI::App& kdray);
Command add_tune(CLI::App& kdray);
Command add_warm_up(CLI::App& kdray);
Command add_view(CLI::App& kdray);

}  // namespace kdray::cli
