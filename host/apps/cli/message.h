// What    What a person reads: one-line messages on stderr, and numbers in words.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace kdray::cli {

// `text` on one line and without control characters: file names and parsers' messages may hold anything.
std::string one_line(std::string_view text);

// "kdray: TEXT" on stderr.
void say(std::string_view text);

// Whether stderr is a terminal on which a line can be drawn anew.
bool can_redraw();

std::string in_words(double count);               // 1234567 -> "1.23 M"
std::string seconds_in_words(double seconds);     // 0.00123 -> "1.23 ms", 75 -> "1 min 15 s"
std::string bytes_in_words(std::uint64_t bytes);  // 1536 -> "1.5 KiB"

}  // namespace kdray::cli
