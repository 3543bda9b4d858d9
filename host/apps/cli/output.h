// What    Where results go: text and pictures to a file or to stdout, and the name that a picture has by
//         default. Which names may be written at all is run_files.h's matter.
// Errors  kdray::Error, ErrorCode::input: what can't be written.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "io/image/write.h"

namespace kdray::cli {

// Text goes to a file, whole or not at all, or to stdout when it is called "-".
void write_text(const std::filesystem::path& file, std::string_view text);

// Text to stdout; throws when it does not arrive whole (a full disk behind a redirection).
void print(std::string_view text);

// The ending, lower case: "a.PNG" -> ".png".
std::string ending_of(const std::filesystem::path& file);

// "scenes/dragon.ply.xz" -> "dragon.png", in the current folder; a scene from stdin, "-", has "stdin.png".
std::filesystem::path default_picture(const std::filesystem::path& scene,
                                      image::PictureFormat format = image::PictureFormat::png);

// As image::write_picture, or to stdout when the file is called "-": a PNG unless the options say otherwise.
image::Written put_picture(const std::filesystem::path& file, const image::Image& image,
                           std::span<const image::Channel> channels, const image::WriteOptions& options);

}  // namespace kdray::cli
