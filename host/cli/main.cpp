// What    The program: the command line to a command, what is thrown to an exit code.
// Errors  0 done, 1 input, 2 usage, 3 no device, 4 out of memory (docs/cli.md); always one line
//         on stderr.
#include <fmt/format.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.h"
#include "cli/message.h"
#include "cli/output.h"
#include "kdray/error.h"

namespace kdray::cli {

namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 done; 1 the input or a file is at fault; 2 usage; 3 no usable device; 4 out of memory.";
constexpr const char* kMoreHelp = "'kdray COMMAND --help' shows a command's options.\n";

// A named command that is not there is told what is; CLI11 would only call it unexpected.
void check_command_name(int argc, char** argv, const std::vector<Command>& commands) {
  if (argc >= 2 && argv[1][0] == '-') return;
  std::vector<std::string> names;
  for (const Command& c : commands) names.push_back(c.app->get_name());
  if (argc < 2)
    throw Error(ErrorCode::usage,
                fmt::format("a command is missing: {}; see 'kdray --help'", fmt::join(names, ", ")));
  if (std::find(names.begin(), names.end(), argv[1]) == names.end())
    throw Error(ErrorCode::usage, fmt::format("there is no command '{}'; the commands are {}", argv[1],
                                              fmt::join(names, ", ")));
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("kdray, an SPMD ray tracer: kd-trees and OpenCL", "kdray");
  app.set_version_flag("--version", "kdray " KDRAY_VERSION);
  app.require_subcommand(1);
  app.footer(kExitCodes);  // the commands inherit it
  app.get_formatter()->column_width(24);
  const std::vector<Command> commands = {
      add_render(app),   add_trace(app),   add_info(app),   add_devices(app), add_doctor(app),
      add_generate(app), add_compare(app), add_verify(app), add_tune(app),    add_bench(app)};
  check_command_name(argc, argv, commands);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    const auto chosen = app.get_subcommands();
    print(chosen.empty() ? app.help() + kMoreHelp : chosen.front()->help("kdray"));
    return 0;
  } catch (const CLI::CallForVersion& version) {
    print(std::string(version.what()) + "\n");
    return 0;
  } catch (const CLI::ParseError& error) {
    const auto chosen = app.get_subcommands();
    const std::string where = chosen.empty() ? "kdray" : "kdray " + chosen.front()->get_name();
    throw Error(ErrorCode::usage, fmt::format("{}; see '{} --help'", error.what(), where));
  }
  for (const Command& c : commands)
    if (c.app->parsed()) return c.run();
  return 0;
}

int exit_code(ErrorCode code) {
  return code == ErrorCode::internal ? 1 : static_cast<int>(code);
}

}  // namespace

}  // namespace kdray::cli

namespace kdray::cli {
namespace {

// What is freed stays with the process: the first touch of a page costs many times a later one
// (base/memory.h), and a frame's film finds the pages that the build has left.
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 2147483647);
}

}  // namespace
}  // namespace kdray::cli

int main(int argc, char** argv) {
  kdray::cli::keep_freed_memory();
  using namespace kdray;
  try {
    return cli::parse_and_run(argc, argv);
  } catch (const Error& error) {
    cli::say(error.what());
    return cli::exit_code(error.code());
  } catch (const std::bad_alloc&) {
    cli::say(
        "out of memory; what would fit is a smaller --size, fewer --aov channels or a scene of fewer "
        "primitives");
    return cli::exit_code(ErrorCode::out_of_memory);
  } catch (const std::exception& error) {
    cli::say(error.what());
    return cli::exit_code(ErrorCode::internal);
  }
}
