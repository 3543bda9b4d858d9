// What    The commands: each adds its subcommand and options to the command line and says what to run when it
//         was chosen. One file per command. And what kdray and kdray-bench have in common as programs: they
//         turn the command line into a command, and what is thrown into an exit code.
// Errors  kdray::Error, which run_program() turns into an exit code; a command's `run` returns the exit code
//         otherwise: 0 done, 1 input, 2 usage, 3 no device, 4 out of memory (docs/cli.md); always one line on
//         stderr.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <span>
#include <string>
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

// Sets what help says of all commands. Has to be called before a command is added, since commands inherit it.
void prepare(CLI::App& app);

// Parses the arguments, of which the first is the program's name, and runs the command. Prints help and
// version where they are asked for. Returns the exit code.
int parse_and_run(CLI::App& app, std::span<const char* const> arguments, std::span<const Command> commands);

// Runs it and returns what main() is to return.
int run_program(const std::function<int()>& run);

// What this kdray is and what it was built with. Nothing of the machine, the folder or the time: two builds
// of the same source have the same text.

// Returns lines for --version, the first of which is "kdray 0.1.0".
std::string version_text();

// Returns "2026-11-26": the day of the commit; nothing where the source is no checkout.
std::string commit_date();

// What was meant by a name that kdray doesn't know: one that is nearly the same, or kdray's own where the
// name is another program's.

// Returns "did you mean 'render'? ", or nothing when none of the names is near. Options begin with "--".
std::string suggestion(const std::string& word, const std::vector<std::string>& names);

}  // namespace kdray::cli
