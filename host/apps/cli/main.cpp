// What    The program kdray: its commands, and the one that is a program of its own.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/ranks.h"
#include "apps/cli/self_test.h"
#include "base/signals.h"
#include "kdray/error.h"

namespace kdray::cli {

namespace {

// `kdray bench` is a program of its own, kdray-bench, which lies beside kdray: those who only render need not
// carry what only measures. kdray becomes that program: the process stays, and with it its standard streams,
// the signals sent to it and the exit status.

constexpr const char* kProgram = "kdray-bench";

// Returns the path of the running program, whatever link or search path it was started by.
std::filesystem::path own_path() {
  std::error_code none;  // without /proc: the folder that kdray is run in
  return std::filesystem::read_symlink("/proc/self/exe", none);
}

// Returns what follows "bench" in kdray's arguments, of which the first is the program's name; nothing where
// another command is asked for.
std::optional<std::vector<std::string>> arguments_of_bench(std::span<const char* const> arguments) {
  const auto is = [&](std::size_t i, std::string_view word) {
    return i < arguments.size() && arguments[i] == word;
  };
  if (is(1, "bench")) return std::vector<std::string>(arguments.begin() + 2, arguments.end());
  if ((is(1, "--help") || is(1, "-h")) && is(2, "bench")) {
    std::vector<std::string> more(arguments.begin() + 3, arguments.end());
    more.emplace_back("--help");
    return more;
  }
  return {};
}

// Throws ErrorCode::input where there is no such program or where it can't be run.
[[noreturn]] void start_bench(const std::vector<std::string>& arguments) {
  const std::filesystem::path program = own_path().replace_filename(kProgram);
  std::vector<char*> argv = {const_cast<char*>(kProgram)};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  leave_signals_alone();
  ::execv(program.c_str(), argv.data());
  if (errno == ENOENT)
    throw input_error(program.string(), 0, "no such file: this kdray comes without the program that measures",
                      "install it, or build it (target kdray_bench_program), and put it beside kdray");
  throw input_error(program.string(), 0, std::string("can't be run: ") + std::strerror(errno),
                    "install it anew beside kdray");
}

// Adds the command to the list in kdray's help.
Command add_bench(CLI::App& kdray) {
  CLI::App* const app =
      kdray.add_subcommand("bench", "Measure rays or frames, beside Embree and POV-Ray where they are");
  return {app, [app]() -> int { start_bench(app->remaining()); }};
}

// Throws for a command that does not exist, with the list of those that do; CLI11 would only call it
// unexpected.
void check_command_name(int argc, char** argv, const std::vector<Command>& commands) {
  if (argc >= 2 && argv[1][0] == '-') return;
  std::vector<std::string> names;
  for (const Command& c : commands) names.push_back(c.app->get_name());
  if (argc < 2)
    throw Error(ErrorCode::usage,
                fmt::format("a command is missing: {}; see 'kdray --help'", fmt::join(names, ", ")));
  if (std::find(names.begin(), names.end(), argv[1]) == names.end())
    throw Error(ErrorCode::usage, fmt::format("there is no command '{}'; {}the commands are {}", argv[1],
                                              suggestion(argv[1], names), fmt::join(names, ", ")));
}

int run_kdray(int argc, char** argv) {
  if (const auto arguments = arguments_of_bench({argv, argv + argc})) start_bench(*arguments);
  CLI::App app;
  prepare(app);
  const std::vector<Command> commands = {
      add_render(app),   add_view(app),    add_trace(app),  add_info(app), add_devices(app), add_doctor(app),
      add_generate(app), add_compare(app), add_verify(app), add_tune(app), add_warm_up(app), add_bench(app)};
  check_command_name(argc, argv, commands);
  return parse_and_run(app, {argv, argv + argc}, commands);
}

}  // namespace

}  // namespace kdray::cli

int main(int argc, char** argv) {
  kdray::cli::try_if_asked(argc, argv);
  return kdray::cli::run_program([&] {
    return kdray::cli::run_in_ranks({argv, argv + argc}, [&] { return kdray::cli::run_kdray(argc, argv); });
  });
}
