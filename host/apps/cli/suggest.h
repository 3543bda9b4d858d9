// What    Names that are nearly right: which command or option was meant.
// Errors  kdray::Error, ErrorCode::usage.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace kdray::cli {

// "did you mean 'render'? ", or nothing when none of the names is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& names);

// Throws for the first option, or name of a command, that the command which was parsed last doesn't know.
// CLI11 would only call it unexpected, or hide it behind another argument that is missing.
void check_unknown(const CLI::App& app);

// The command that was parsed last, as it is called: "kdray bench rays".
std::string parsed_command(const CLI::App& app);

}  // namespace kdray::cli
