#include "apps/cli/help.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>

namespace kdray::cli {

namespace {

constexpr std::size_t kNarrow = 40, kUsual = 100;  // characters of a line
constexpr std::size_t kColumn = 24;                // where descriptions begin

constexpr std::array<ExitCode, 5> kExitCodes = {{{0, "done"},
                                                 {1, "the input or a file is at fault"},
                                                 {2, "usage"},
                                                 {3, "no usable device"},
                                                 {4, "out of memory"}}};

std::string group_of(const CLI::App& app, const CLI::Option* option) {
  const bool is_general = option == app.get_help_ptr() || option->check_lname("version");
  return is_general ? kGeneralGroup : option->get_group();
}

// The place of a group before others; those of the same place keep their order.
int place_of(const std::string& group) {
  if (group == kMostUsedGroup) return 0;
  if (group == "Options") return 1;  // CLI11's name for having none
  return group == kGeneralGroup ? 3 : 2;
}

// Lines of `width` characters at most, each but the first after an indentation. Words are never broken.
std::string wrapped(std::string_view text, std::size_t indent, std::size_t width) {
  std::string lines;
  std::size_t column = indent;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::size_t length = end - at;
    if (column > indent && column + 1 + length > width) {
      lines += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      lines += ' ', ++column;
    }
    lines += text.substr(at, length);
    column += length;
    at = end + 1;
  }
  return lines;
}

std::string help_entry(const std::string& name, const std::string& description, std::size_t width) {
  const std::string start = "  " + name;
  const std::string gap = start.size() + 2 > kColumn ? "\n" + std::string(kColumn, ' ')
                                                     : std::string(kColumn - start.size(), ' ');
  return start + gap + wrapped(description, kColumn, width) + "\n";
}

std::string usage_of(const CLI::App& app) {
  std::string usage = command_of(app);
  if (!app.get_subcommands({}).empty()) usage += " COMMAND";
  for (const CLI::Option* const o : positionals_of(app)) {
    const std::string name = o->get_name() + (o->get_items_expected_max() > 1 ? "..." : "");
    usage += o->get_required() ? " " + name : " [" + name + "]";
  }
  return usage + " [options]";
}

std::string in_words(std::span<const ExitCode> codes) {
  std::vector<std::string> parts;
  for (const ExitCode& c : codes) parts.push_back(fmt::format("{} {}", c.code, c.meaning));
  return fmt::format("Exit codes: {}.", fmt::join(parts, "; "));
}

}  // namespace

std::vector<const CLI::Option*> positionals_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* o) { return o->get_positional(); });
}

std::vector<OptionGroup> groups_of(const CLI::App& app) {
  std::vector<OptionGroup> groups;
  for (const CLI::Option* const option : app.get_options({})) {
    const std::string group = group_of(app, option);
    if (option->get_positional() || group.empty()) continue;
    auto found = std::ranges::find(groups, group, &OptionGroup::title);
    if (found == groups.end()) found = groups.insert(found, OptionGroup{group, {}});
    found->options.push_back(option);
  }
  std::ranges::stable_sort(groups, {}, [](const OptionGroup& g) { return place_of(g.title); });
  return groups;
}

void put_into_group(CLI::App& app, const char* group, std::span<const char* const> names) {
  for (const char* const name : names)
    if (CLI::Option* const option = app.get_option_no_throw(name)) option->group(group);
}

std::string names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string shape_of(const CLI::Option& option) {
  return option.get_items_expected_max() > 0 ? option.get_type_name() : "";
}

std::string description_of(const CLI::Option& option) {
  std::string text = option.get_description();
  for (const CLI::Option* const other : option.get_excludes())
    text += fmt::format(" (not with {})", names_of(*other));
  return text + (option.get_required() && !option.get_positional() ? " (required)" : "");
}

std::string command_of(const CLI::App& app) {
  const CLI::App* const above = app.get_parent();
  return above == nullptr ? app.get_name() : command_of(*above) + " " + app.get_name();
}

std::span<const ExitCode> exit_codes() {
  return kExitCodes;
}

std::size_t help_width() {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsual;
  return std::clamp<std::size_t>(size.ws_col, kNarrow, kUsual);
}

std::string help_of(const CLI::App& app, std::size_t width) {
  std::string text = wrapped(app.get_description(), 0, width) + "\n\nUsage: " + usage_of(app) + "\n";
  if (const auto positionals = positionals_of(app); !positionals.empty()) text += "\n";
  for (const CLI::Option* const o : positionals_of(app))
    text += help_entry(o->get_name(), description_of(*o), width);
  const auto commands = app.get_subcommands({});
  if (!commands.empty()) text += "\nCommands:\n";
  for (const CLI::App* const command : commands)
    text += help_entry(command->get_name(), command->get_description(), width);
  for (const OptionGroup& group : groups_of(app)) {
    text += "\n" + group.title + ":\n";
    for (const CLI::Option* const o : group.options) {
      const std::string shape = shape_of(*o);
      text += help_entry(names_of(*o) + (shape.empty() ? "" : " " + shape), description_of(*o), width);
    }
  }
  if (!app.get_footer().empty()) text += "\n" + app.get_footer() + "\n";
  text += "\n" + wrapped(in_words(kExitCodes), 0, width) + "\n";
  if (!commands.empty())
    text += fmt::format("'kdray help {}COMMAND' shows a command's options.\n",
                        app.get_parent() == nullptr ? "" : app.get_name() + " ");
  return text;
}

}  // namespace kdray::cli
