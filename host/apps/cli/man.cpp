// What    Man pages, by the macros of man(7).
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "apps/cli/command.h"
#include "apps/cli/help.h"
#include "base/write_file.h"

namespace kdray::cli {

namespace {

// As roff is to read it: a dash that can be copied, and no request at the beginning of a line.
std::string in_roff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '-' || c == '\\') {
      out += c == '-' ? "\\-" : "\\e";
    } else if (c == '\'' || c == '.') {
      out += c == '\'' ? "\\(aq" : "\\&.";
    } else {
      out += c;
    }
  }
  return out;
}

// "kdray-bench-rays"
std::string page_of(const CLI::App& app) {
  std::string name = command_of(app);
  std::ranges::replace(name, ' ', '-');
  return name;
}

std::string man_entry(const std::string& names, const std::string& shape, const std::string& description) {
  const std::string value = shape.empty() ? "" : " \\fI" + in_roff(shape) + "\\fR";
  return fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", in_roff(names), value, in_roff(description));
}

std::string synopsis_of(const CLI::App& app) {
  std::string words;
  if (!app.get_subcommands({}).empty()) words += " \\fICOMMAND\\fR";
  for (const CLI::Option* const o : positionals_of(app)) {
    const std::string name = "\\fI" + in_roff(o->get_name()) + "\\fR";
    words += o->get_required() ? " " + name : " [" + name + "]";
    if (o->get_items_expected_max() > 1) words += " ...";
  }
  return fmt::format("\\fB{}\\fR{} [\\fIoptions\\fR]\n", in_roff(command_of(app)), words);
}

std::string man_options(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* const o : positionals_of(app))
    text += man_entry(o->get_name(), "", description_of(*o));
  for (const OptionGroup& group : groups_of(app)) {
    text += ".SS " + group.title + "\n";
    for (const CLI::Option* const o : group.options)
      text += man_entry(names_of(*o), shape_of(*o), description_of(*o));
  }
  return text;
}

// The command above and those below: where one reads on.
std::string see_also(const CLI::App& app) {
  std::vector<std::string> pages;
  if (const CLI::App* const above = app.get_parent(); above != nullptr) pages.push_back(page_of(*above));
  for (const CLI::App* const below : app.get_subcommands({})) pages.push_back(page_of(*below));
  std::string text;
  for (std::size_t i = 0; i < pages.size(); ++i)
    text += fmt::format(".BR {} (1){}\n", in_roff(pages[i]), i + 1 < pages.size() ? "," : "");
  return text;
}

}  // namespace

std::string man_page(const CLI::App& app) {
  const std::string page = page_of(app);
  std::string title = page, purpose = app.get_description();
  std::ranges::transform(title, title.begin(), [](unsigned char c) { return std::toupper(c); });
  if (app.get_parent() != nullptr)
    purpose[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(purpose[0])));
  std::string text = fmt::format(".TH {} 1 \"{}\" \"kdray {}\" \"User Commands\"\n", in_roff(title),
                                 commit_date(), KDRAY_VERSION);
  text += fmt::format(".SH NAME\n{} \\- {}\n", in_roff(page), in_roff(purpose));
  text += ".SH SYNOPSIS\n" + synopsis_of(app);
  if (const auto commands = app.get_subcommands({}); !commands.empty()) text += ".SH COMMANDS\n";
  for (const CLI::App* const command : app.get_subcommands({}))
    text += man_entry(command->get_name(), "", command->get_description());
  text += ".SH OPTIONS\n" + man_options(app);
  if (!app.get_footer().empty()) text += ".SH NOTES\n.nf\n" + in_roff(app.get_footer()) + "\n.fi\n";
  text += ".SH \"EXIT STATUS\"\n";
  for (const ExitCode& c : exit_codes()) text += man_entry(std::to_string(c.code), "", c.meaning);
  return text + ".SH \"SEE ALSO\"\n" + see_also(app);
}

void write_man_pages(std::span<const CLI::App* const> apps, const std::filesystem::path& folder) {
  for (const CLI::App* const app : apps) {
    write_file(folder / (page_of(*app) + ".1"), man_page(*app));
    if (app->get_parent() == nullptr) continue;  // its commands are named, or are another program's
    const auto below = app->get_subcommands({});
    write_man_pages(below, folder);
  }
}

}  // namespace kdray::cli
