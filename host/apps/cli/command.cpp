#include "apps/cli/command.h"

#include <fmt/format.h>
#include <malloc.h>

#include <exception>
#include <new>
#include <string>
#include <vector>

#include "apps/cli/help.h"
#include "apps/cli/output.h"
#include "apps/cli/suggestion.h"
#include "apps/cli/version.h"
#include "base/signals.h"
#include "kdray/error.h"

namespace kdray::cli {

namespace {

// Has memory that is freed stay with the process: the first touch of a page costs many times a later one
// (base/memory.h), and a frame's film finds the pages that the build has left.
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 2147483647);
}

int exit_code(ErrorCode code) {
  return code == ErrorCode::internal ? 1 : static_cast<int>(code);
}

const CLI::App& innermost(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : innermost(*chosen.front());
}

std::vector<std::string> names_known_to(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* const below : command.get_subcommands({})) names.push_back(below->get_name());
  return names;
}

// Throws for the first option, or name of a command, that the command which was parsed last doesn't know.
// CLI11 would only call it unexpected, or hide it behind another argument that is missing.
void check_unknown(const CLI::App& app) {
  const CLI::App& command = innermost(app);
  for (const std::string& word : command.remaining()) {
    const bool is_option = word.starts_with("-") && word != "-";
    if (!is_option && command.get_subcommands({}).empty()) continue;
    const std::string name = word.substr(0, word.find('='));
    throw Error(ErrorCode::usage,
                fmt::format("there is no {} '{}'; {}see '{} --help'", is_option ? "option" : "command", name,
                            suggestion(name, names_known_to(command)), command_of(command)));
  }
}

}  // namespace

void prepare(CLI::App& app) {
  app.description("kdray, an SPMD ray tracer: kd-trees and OpenCL");
  app.name("kdray");
  app.set_help_flag("-h,--help", "List the options");
  app.set_version_flag("--version", version_text(), "Print the version, and what it was built with");
  app.require_subcommand(1);
}

int parse_and_run(CLI::App& app, std::span<const char* const> arguments, std::span<const Command> commands) {
  try {
    app.parse(static_cast<int>(arguments.size()), arguments.data());
  } catch (const CLI::CallForHelp&) {
    print(help_of(innermost(app), help_width()));
    return 0;
  } catch (const CLI::CallForVersion& version) {
    print(version.what());
    return 0;
  } catch (const CLI::ParseError& error) {
    check_unknown(app);
    throw Error(ErrorCode::usage,
                fmt::format("{}; see '{} --help'", error.what(), command_of(innermost(app))));
  }
  for (const Command& c : commands)
    if (c.app->parsed()) return c.run();
  return 0;
}

int run_program(const std::function<int()>& run) {
  keep_freed_memory();
  mind_signals();  // before there are other threads
  try {
    return run();
  } catch (const Error& error) {
    say(error.what());
    return exit_code(error.code());
  } catch (const std::bad_alloc&) {
    say("out of memory; what would fit is a smaller --size, fewer --aov channels or a scene of fewer "
        "primitives");
    return exit_code(ErrorCode::out_of_memory);
  } catch (const std::exception& error) {
    say(error.what());
    return exit_code(ErrorCode::internal);
  }
}

}  // namespace kdray::cli
