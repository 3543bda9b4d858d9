#include "apps/cli/command.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <exception>
#include <new>
#include <string_view>

#include "apps/cli/help.h"
#include "apps/cli/output.h"
#include "base/error.h"
#include "base/signals.h"
#include "build_facts.h"
#include "commit.h"
#include "kdray/error.h"
#include "scene/import/load.h"

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
  bool may_be_option = true;  // behind "--" nothing is
  for (const std::string& word : command.remaining()) {
    if (word == "--") {
      may_be_option = false;
      continue;
    }

    const bool is_option = may_be_option && word.starts_with("-") && word != "-";

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

namespace {

std::string line(std::string_view name, std::string_view text) {
  return text.empty() ? "" : fmt::format("{:<10}{}\n", name, text);
}

// "JPEG pictures; no WebP pictures"
std::string formats() {
  std::string text;
  for (const scene::Ability& a : scene::abilities())
    text += fmt::format("{}{}{}", text.empty() ? "" : "; ", a.here ? "" : "no ", a.what);
  return text;
}

}  // namespace

std::string version_text() {
  const std::string_view commit = KDRAY_COMMIT, mpi = KDRAY_MPI, page = KDRAY_PAGE;
  return "kdray " KDRAY_VERSION "\n" +
         line("commit", commit.empty() ? "" : fmt::format("{} of {}", commit, KDRAY_COMMIT_DATE)) +
         line("compiler", KDRAY_COMPILER ", " KDRAY_BUILD_TYPE ", " KDRAY_PROCESSOR KDRAY_SANITIZERS) +
         line("OpenCL", "headers " KDRAY_OPENCL_HEADERS
                        "; PoCL and other drivers are found when it runs: kdray devices") +
         line("MPI", mpi == "ON" ? "libkdray-mpi.so was built" : "none: MPI was missing") +
         line("page", page == "ON" ? "kdray view is there" : "none: Boost or libjpeg-turbo was missing") +
         line("reads", formats());
}

std::string commit_date() {
  return KDRAY_COMMIT_DATE;
}

namespace {

struct OtherWord {
  std::string_view word, ours;
};

// Options of other renderers and viewers, and what they are here.
constexpr OtherWord kOtherWords[] = {
    {"width", "--size WxH"},
    {"height", "--size WxH"},
    {"resolution", "--size WxH"},
    {"res", "--size WxH"},
    {"dimensions", "--size WxH"},
    {"geometry", "--size WxH"},
    {"w", "--size WxH"},
    {"W", "--size WxH"},
    {"H", "--size WxH"},
    {"spp", "--samples"},
    {"antialias", "--samples"},
    {"antialiasing", "--samples"},
    {"anti-aliasing", "--samples"},
    {"aa", "--samples"},
    {"max-depth", "--depth"},
    {"bounces", "--depth"},
    {"max-bounces", "--depth"},
    {"recursion", "--depth"},
    {"out", "--output"},
    {"outfile", "--output"},
    {"eye", "--from"},
    {"position", "--from"},
    {"camera-position", "--from"},
    {"lookfrom", "--from"},
    {"look-from", "--from"},
    {"lookat", "--at"},
    {"look-at", "--at"},
    {"target", "--at"},
    {"camera-target", "--at"},
    {"focal-point", "--at"},
    {"camera-focal-point", "--at"},
    {"up-axis", "--up"},
    {"view-up", "--up"},
    {"camera-view-up", "--up"},
    {"angle", "--fov"},
    {"view-angle", "--fov"},
    {"camera-view-angle", "--fov"},
    {"field-of-view", "--fov"},
    {"zoom", "--fov"},
    {"orthographic", "--ortho"},
    {"bg", "--background"},
    {"bg-color", "--background"},
    {"background-color", "--background"},
    {"no-background", "--background transparent"},
    {"transparent", "--background transparent"},
    {"alpha", "--background transparent"},
    {"gpu", "--device gpu"},
    {"cpu", "--device cpu"},
    {"channels", "--aov"},
    {"passes", "--aov"},
    {"normals", "--aov normal"},
    {"seconds", "--time"},
    {"animation-time", "--time"},
    {"framerate", "--fps"},
    {"silent", "--quiet"},
};

std::string_view without_dashes(std::string_view word) {
  return word.substr(std::min(word.find_first_not_of('-'), word.size()));
}

// Returns our option for another program's, where the command has it; nothing otherwise.
std::string_view counterpart(std::string_view word, const std::vector<std::string>& names) {
  const auto* const found = std::ranges::find(kOtherWords, without_dashes(word), &OtherWord::word);
  if (!word.starts_with('-') || found == std::end(kOtherWords)) return {};
  const std::string_view option = found->ours.substr(0, found->ours.find(' '));
  return std::ranges::find(names, option) == names.end() ? std::string_view() : found->ours;
}

}  // namespace

std::string suggestion(const std::string& word, const std::vector<std::string>& names) {
  if (const std::string_view ours = counterpart(word, names); !ours.empty())
    return fmt::format("did you mean '{}'? ", ours);
  const bool is_option = word.starts_with("--");
  std::vector<std::string_view> comparable;
  for (const std::string& name : names)
    if (name.starts_with("--") == is_option) comparable.push_back(without_dashes(name));
  const std::string_view nearest = nearest_name(without_dashes(word), comparable);
  return nearest.empty() ? "" : fmt::format("did you mean '{}{}'? ", is_option ? "--" : "", nearest);
}

}  // namespace kdray::cli
