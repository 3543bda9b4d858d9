// What    The program kdray: its commands, and the one that is a program of its own.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/command_line.h"
#include "apps/cli/ranks.h"
#include "apps/cli/start_bench.h"
#include "apps/cli/suggest.h"
#include "apps/cli/try.h"
#include "kdray/error.h"

namespace kdray::cli {

namespace {

// A named command that is not there is told what is; CLI11 would only call it unexpected.
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
