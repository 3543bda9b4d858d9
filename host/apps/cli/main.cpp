// What    The program kdray: its commands, and the one that is a program of its own.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/help.h"
#include "apps/cli/output.h"
#include "apps/cli/ranks.h"
#include "apps/cli/self_test.h"
#include "base/error.h"
#include "base/signals.h"
#include "scene/import/load.h"

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

// Returns what kdray-bench is to be started with for these arguments of kdray, of which the first is the
// program's name; nothing where they are about another command.
std::optional<std::vector<std::string>> arguments_of_bench(std::span<const char* const> arguments) {
  const auto is = [&](std::size_t i, std::string_view word) {
    return i < arguments.size() && arguments[i] == word;
  };
  if (is(1, "bench")) return std::vector<std::string>(arguments.begin() + 2, arguments.end());
  if (!is(2, "bench")) return {};
  if (is(1, "--complete")) return std::vector<std::string>(arguments.begin() + 1, arguments.end());
  if (!is(1, "help") && !is(1, "--help") && !is(1, "-h")) return {};
  std::vector<std::string> more(arguments.begin() + 3, arguments.end());
  more.emplace_back("--help");
  return more;
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

std::vector<std::string> command_names(const CLI::App& kdray) {
  std::vector<std::string> names;
  for (const CLI::App* const command : kdray.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

// Throws for a command that does not exist, with the list of those that do, or with what is to be done with
// a scene; CLI11 would only call it unexpected.
void check_command_name(const std::string& name, const CLI::App& kdray) {
  const std::vector<std::string> names = command_names(kdray);
  if (std::ranges::find(names, name) != names.end()) return;
  if (scene::is_scene_name(name))
    throw Error(ErrorCode::usage,
                fmt::format("'{0}' is a scene and no command; kdray render {0}, or kdray view {0}", name));
  throw Error(ErrorCode::usage, fmt::format("there is no command '{}'; {}the commands are {}", name,
                                            suggestion(name, names), fmt::join(names, ", ")));
}

Command add_help(CLI::App& kdray) {
  CLI::App* const app = kdray.add_subcommand("help", "List the options of a command");
  const auto name = std::make_shared<std::string>();
  app->add_option("COMMAND", *name, "The command (default: list the commands)")->type_name("");
  return {app, [&kdray, name] {
            if (!name->empty()) check_command_name(*name, kdray);
            print(help_of(name->empty() ? kdray : *kdray.get_subcommand(*name), help_width()));
            return 0;
          }};
}

int run_kdray(int argc, char** argv) {
  const std::span<const char* const> arguments(argv, static_cast<std::size_t>(argc));
  if (const auto others = arguments_of_bench(arguments)) start_bench(*others);
  CLI::App app;
  prepare(app);
  const std::vector<Command> commands = {
      add_render(app),  add_view(app),     add_trace(app),   add_info(app),   add_devices(app),
      add_doctor(app),  add_generate(app), add_compare(app), add_verify(app), add_tune(app),
      add_warm_up(app), add_bench(app),    add_help(app)};
  std::vector<const CLI::App*> pages = {&app};
  for (const Command& c : commands)
    if (c.app->get_name() != "bench") pages.push_back(c.app);  // kdray-bench has its pages
  if (answer_shells(app, pages, arguments)) return 0;
  if (argc < 2)
    throw Error(ErrorCode::usage, fmt::format("a command is missing: {}; see 'kdray help'",
                                              fmt::join(command_names(app), ", ")));
  if (argv[1][0] != '-') check_command_name(argv[1], app);
  return parse_and_run(app, arguments, commands);
}

}  // namespace

}  // namespace kdray::cli

int main(int argc, char** argv) {
  kdray::cli::try_if_asked(argc, argv);
  return kdray::cli::run_program([&] {
    return kdray::cli::run_in_ranks({argv, argv + argc}, [&] { return kdray::cli::run_kdray(argc, argv); });
  });
}
