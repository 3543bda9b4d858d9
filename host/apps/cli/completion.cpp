// What    What a shell may complete a command line with. The shell's part is a few lines that ask kdray each
//         time, so that they know what this kdray knows.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "apps/cli/help.h"
#include "apps/cli/options.h"
#include "apps/cli/output.h"

namespace kdray::cli {

namespace {

// bash divides "--mode=pd" into three words, the second of which is "=".
constexpr const char* kBash = R"(# Completions of kdray for bash
_kdray() {
  local program=${COMP_WORDS[0]/#\~/$HOME}
  mapfile -t COMPREPLY < <("$program" --complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null | cut -f1)
}
complete -o bashdefault -o default -F _kdray kdray
)";

constexpr const char* kZsh = R"(#compdef kdray
# Completions of kdray for zsh
_kdray() {
  local line program="${(Q)words[1]}"
  local -a found
  for line in "${(@f)$("$program" --complete "${(@Q)words[2,CURRENT-1]}" "${(Q)PREFIX}" 2>/dev/null)}"; do
    [[ -n $line ]] && found+=("${${line%%$'\t'*}//:/\\:}:${line#*$'\t'}")
  done
  if (( $#found )); then _describe kdray found; else _files; fi
}
if [[ $funcstack[1] == _kdray ]]; then _kdray "$@"; else compdef _kdray kdray; fi
)";

constexpr const char* kFish = R"(# Completions of kdray for fish
function __kdray_complete
    set -l words (commandline -opc)
    set -l program $words[1]
    set -e words[1]
    set -l found ($program --complete $words (commandline -ct) 2>/dev/null)
    if set -q found[1]
        printf '%s\n' $found
    else
        __fish_complete_path (commandline -ct)
    end
end
complete -c kdray -f -a '(__kdray_complete)'
)";

constexpr std::array<std::string_view, 3> kShells = {"bash", "zsh", "fish"}, kScripts = {kBash, kZsh, kFish};

std::string candidate(const std::string& word, const std::string& what) {
  return word + "\t" + what + "\n";
}

// Returns the words in small letters of "N|adaptive[:TARGET]": "adaptive".
std::vector<std::string> values_in(std::string_view shape) {
  std::vector<std::string> values;
  for (std::size_t start = 0; start <= shape.size();) {
    const std::size_t bar = std::min(shape.find('|', start), shape.size());
    std::string_view value = shape.substr(start, bar - start);
    value = value.substr(0, value.find('['));
    const auto is_capital = [](unsigned char c) { return std::isupper(c) != 0; };
    if (!value.empty() && std::ranges::none_of(value, is_capital)) values.emplace_back(value);
    start = bar + 1;
  }
  return values;
}

// A command line up to its last word.
struct Parsed {
  const CLI::App* command = nullptr;
  const CLI::Option* awaiting = nullptr;  // its value is next
  std::set<const CLI::Option*> given = {};
};

const CLI::Option* option_of(const CLI::App& app, const std::string& word) {
  return word.size() > 1 && word[0] == '-' ? app.get_option_no_throw(word.substr(0, word.find('=')))
                                           : nullptr;
}

const CLI::App* command_below(const CLI::App& app, const std::string& word) {
  for (const CLI::App* const below : app.get_subcommands({}))
    if (below->get_name() == word) return below;
  return nullptr;
}

Parsed parsed(const CLI::App& kdray, std::span<const std::string> words) {
  Parsed p{&kdray};
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (p.awaiting != nullptr) {
      if (words[i] != "=") p.awaiting = nullptr;
    } else if (const CLI::Option* const option = option_of(*p.command, words[i]); option != nullptr) {
      p.given.insert(option);
      if (!shape_of(*option).empty() && words[i].find('=') == std::string::npos) p.awaiting = option;
    } else if (const CLI::App* const below = command_below(*p.command, words[i]); below != nullptr) {
      p.command = below;
    }
  }
  return p;
}

// The values of an option as a line each, after `before`; of a list each name that isn't in it yet.
std::string value_lines(const CLI::Option& option, const std::string& before, const std::string& word) {
  const std::string shape = shape_of(option);
  const std::size_t comma = shape.ends_with("[,...]") ? word.rfind(',') : std::string::npos;
  const std::string done = comma == std::string::npos ? "" : word.substr(0, comma + 1);
  std::string lines;
  for (const std::string& value : values_in(shape))
    if ((done + value).starts_with(word) && ("," + done).find("," + value + ",") == std::string::npos)
      lines += candidate(before + done + value, option.get_description());
  return lines;
}

std::string option_lines(const Parsed& p, const std::string& word) {
  std::string lines;
  for (const OptionGroup& group : groups_of(*p.command))
    for (const CLI::Option* const option : group.options)
      for (const std::string& name : option->get_lnames())
        if (("--" + name).starts_with(word) && !p.given.contains(option))
          lines += candidate("--" + name, option->get_description());
  return lines;
}

std::string command_lines(const CLI::App& app, const std::string& word) {
  std::string lines;
  for (const CLI::App* const below : app.get_subcommands({}))
    if (below->get_name().starts_with(word)) lines += candidate(below->get_name(), below->get_description());
  return lines;
}

std::string argument_lines(const CLI::App& kdray, const Parsed& p, const std::string& word) {
  if (p.command->get_name() == "help") return command_lines(kdray, word);
  std::string lines = command_lines(*p.command, word);
  for (const CLI::Option* const o : positionals_of(*p.command)) lines += value_lines(*o, "", word);
  return lines;
}

}  // namespace

std::string completions(const CLI::App& kdray, std::span<const std::string> words) {
  if (words.empty()) return command_lines(kdray, "");
  const Parsed p = parsed(kdray, words.first(words.size() - 1));
  const std::string& last = words.back();
  if (p.awaiting != nullptr) return value_lines(*p.awaiting, "", last == "=" ? "" : last);
  const std::size_t equals = last.find('=');
  if (const CLI::Option* const option = option_of(*p.command, last);
      option != nullptr && equals != std::string::npos)
    return value_lines(*option, last.substr(0, equals + 1), last.substr(equals + 1));
  return last.starts_with("-") ? option_lines(p, last) : argument_lines(kdray, p, last);
}

bool answer_shells(const CLI::App& kdray, std::span<const CLI::App* const> pages,
                   std::span<const char* const> arguments) {
  if (arguments.size() < 2) return false;
  const std::string_view asked = arguments[1];
  const std::vector<std::string> words(arguments.begin() + 2, arguments.end());
  if (asked == "--complete")
    print(completions(kdray, words));
  else if (asked == "--completion")
    print(kScripts[parse_choice("--completion", words.empty() ? "" : words.front(), kShells)]);
  else if (asked == "--man" && words.size() == 1)
    write_man_pages(pages, words.front());
  else
    return false;
  return true;
}

}  // namespace kdray::cli
