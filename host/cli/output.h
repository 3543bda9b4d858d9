// What    Where results go: text to a file or stdout, names that are given by default, names that clash.
//         What can't be written is refused before any work is done (base/write_file.h, film/write.h).
// Errors  kdray::Error: ErrorCode::input for a file, ErrorCode::usage for options that contradict each
//         other.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kdray::cli {

// Text goes to a file, whole or not at all, or to stdout when it is called "-".
void check_text_output(const std::filesystem::path& file);
void write_text(const std::filesystem::path& file, std::string_view text);

// Text to stdout; throws when it does not arrive whole (a full disk behind a redirection).
void print(std::string_view text);

// Throws when the two options name the same file: one would destroy the other.
void check_apart(std::string_view option_a, const std::filesystem::path& a, std::string_view option_b,
                 const std::filesystem::path& b);

// The ending, lower case: "a.PNG" -> ".png".
std::string ending_of(const std::filesystem::path& file);

// "scenes/dragon.ply.xz" -> "dragon.png", in the current folder.
std::filesystem::path default_picture(const std::filesystem::path& scene);

}  // namespace kdray::cli
