#include "apps/cli/suggest.h"

#include <fmt/format.h>

#include <string_view>

#include "base/did_you_mean.h"
#include "kdray/error.h"

namespace kdray::cli {

namespace {

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

}  // namespace

std::string suggestion(const std::string& word, const std::vector<std::string>& names) {
  const std::vector<std::string_view> views(names.begin(), names.end());
  const std::string guess = did_you_mean(word, views);
  return guess.empty() ? "" : guess + " ";
}

void check_unknown(const CLI::App& app) {
  const CLI::App& command = innermost(app);
  for (const std::string& word : command.remaining()) {
    const bool is_option = word.starts_with("-") && word != "-";
    if (!is_option && command.get_subcommands({}).empty()) continue;
    const std::string name = word.substr(0, word.find('='));
    throw Error(ErrorCode::usage,
                fmt::format("there is no {} '{}'; {}see '{} --help'", is_option ? "option" : "command", name,
                            suggestion(name, names_known_to(command)), parsed_command(app)));
  }
}

std::string parsed_command(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* at = &app; !at->get_subcommands().empty();) {
    at = at->get_subcommands().front();
    name += " " + at->get_name();
  }
  return name;
}

}  // namespace kdray::cli
