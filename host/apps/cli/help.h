// What    What the commands say of themselves: help, man pages and completions, all of it from their own
//         lists of options, so that a new option is in all three at once.
// Shape   An option's shape (options.h) is read, too: its words in small letters are the values that shells
//         complete, those in capitals stand for any.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace kdray::cli {

// Groups of options that come first and last in help, whatever the order in which they were added; between
// them are an app's options without a group, then the other groups.
inline constexpr const char* kMostUsedGroup = "Most used";
inline constexpr const char* kGeneralGroup = "General";

struct OptionGroup {
  std::string title;
  std::vector<const CLI::Option*> options;
};
std::vector<OptionGroup> groups_of(const CLI::App& app);
std::vector<const CLI::Option*> positionals_of(const CLI::App& app);

// Puts those of the options that the app has into a group.
void put_into_group(CLI::App& app, const char* group, std::span<const char* const> names);

std::string names_of(const CLI::Option& option);        // "-o, --output"
std::string shape_of(const CLI::Option& option);        // "FILE"; nothing for a flag
std::string description_of(const CLI::Option& option);  // also says what it doesn't go with
std::string command_of(const CLI::App& app);            // "kdray bench rays"

struct ExitCode {
  int code;
  const char* meaning;
};
std::span<const ExitCode> exit_codes();

// Returns what --help prints, in lines of so many characters.
std::string help_of(const CLI::App& app, std::size_t width);
// Returns how many characters of help fit on a line of the terminal that standard output is.
std::size_t help_width();

// Returns a page in the man macros of roff.
std::string man_page(const CLI::App& app);
// Writes a page for each of these and for the commands below them: kdray-render.1.
void write_man_pages(std::span<const CLI::App* const> apps, const std::filesystem::path& folder);

// Returns what may stand in place of the last word, after those before it: a line each, "WORD<tab>what it
// is". Nothing: a file, or anything.
std::string completions(const CLI::App& kdray, std::span<const std::string> words);
// Answers what the build and shells ask for: "--man DIR" writes the pages of these commands and of those
// below them, "--completion SHELL" prints the script of bash, zsh or fish, "--complete WORD..." what may
// follow. Returns whether the arguments, of which the first is the program's name, are one of these.
bool answer_shells(const CLI::App& kdray, std::span<const CLI::App* const> pages,
                   std::span<const char* const> arguments);

}  // namespace kdray::cli
