// What    What goes out: results, which are text and pictures, to a file or to stdout, and the name that a
//         picture has by default; one-line messages to stderr; numbers in words. Which names may be written
//         at all is run_files.h's matter.
// Errors  kdray::Error, ErrorCode::input: what can't be written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "io/image/picture_file.h"

namespace kdray::cli {

// Writes text to a file, whole or not at all, or to stdout when the file is called "-".
void write_text(const std::filesystem::path& file, std::string_view text);

// Writes text to stdout; throws when it does not arrive whole (a redirection to a full disk).
void print(std::string_view text);

// Returns the ending in lower case: "a.PNG" -> ".png".
std::string ending_of(const std::filesystem::path& file);

// Returns the picture's name in the current folder: "scenes/dragon.ply.xz" -> "dragon.png"; a scene from
// stdin, "-", has "stdin.png".
std::filesystem::path default_picture(const std::filesystem::path& scene,
                                      image::PictureFormat format = image::PictureFormat::png);

// Writes the picture as image::write_picture does, or to stdout when the file is called "-": a PNG unless the
// options say otherwise.
image::Written put_picture(const std::filesystem::path& file, const image::Image& image,
                           std::span<const image::Channel> channels, const image::WriteOptions& options);

// Returns `text` on one line and without control characters: file names and parsers' messages may hold
// anything.
std::string one_line(std::string_view text);

// Writes "kdray: TEXT" to stderr.
void say(std::string_view text);

// Returns whether stderr is a terminal on which a line can be drawn anew.
bool can_redraw();

std::string in_words(double count);               // 1234567 -> "1.23 M"
std::string seconds_in_words(double seconds);     // 0.00123 -> "1.23 ms", 75 -> "1 min 15 s"
std::string bytes_in_words(std::uint64_t bytes);  // 1536 -> "1.5 KiB"

}  // namespace kdray::cli
