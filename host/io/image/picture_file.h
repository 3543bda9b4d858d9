// What    Picture files: PNG (8 or 16 bit, through a transfer curve) and EXR (float, linear), written and
//         read. The format follows from the name's ending when writing, from the first bytes when reading.
//         Every file is written whole or not at all: beside it first, then renamed (base/write_file.h).
// Errors  kdray::Error, ErrorCode::input: not writable, disk full, an ending or a content that is none of
//         ours.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/write_file.h"
#include "io/image/color.h"
#include "io/image/image.h"

namespace kdray::image {

enum class PictureFormat { png, exr };

// By the name's ending; what is written to a pipe or device of another name is a PNG.
PictureFormat format_for_writing(const std::filesystem::path& file);
PictureFormat format_of_content(std::string_view bytes, const std::filesystem::path& file);

using kdray::write_atomically;

struct WriteOptions {
  Transfer transfer;
  int png_bits = 8;                          // 8 or 16
  double exposure = 0;                       // a PNG shows colours times 2^exposure
  std::optional<PictureFormat> format = {};  // none: by the ending of the file's name
};

struct Written {
  std::vector<std::filesystem::path> files;  // the picture first
  std::size_t nan_values = 0;                // of the colour: 0 in a PNG, kept in an EXR
};

// Writes a picture and its channels. Channels go into the EXR itself ("Z", "N.X" "N.Y" "N.Z", "primitive",
// "cost"), or beside a PNG as NAME.depth.png (16 bit grey, near white to far black, background black),
// NAME.normal.png (8 bit, 0.5 + 0.5*n), NAME.primitive.png (a colour for each number), NAME.cost.png (a heat
// map).
Written write_picture(const std::filesystem::path& file, const Image& image,
                      std::span<const Channel> channels, const WriteOptions& options);

// Counts the values of the colour that are not numbers.
std::size_t count_nan(const Image& image);

// Returns the bytes of a picture file, without the channels that a PNG has beside it.
std::string encode_picture(PictureFormat format, const Image& image, std::span<const Channel> channels,
                           const WriteOptions& options);

// Returns the files that write_picture would write with these channels ("normal" for the three of a normal),
// the picture first. Throws for a name whose ending belongs to no format.
std::vector<std::filesystem::path> picture_files(const std::filesystem::path& file,
                                                 std::span<const std::string> channels,
                                                 const WriteOptions& options);

// Reads PNG (8 or 16 bit, grey, RGB, with or without alpha, palette) and EXR back into linear RGB, with
// alpha where they have it, for comparison. PNG values go through `transfer` backwards; a linear PNG
// wants {.srgb = false, .gamma = 1}.
Image read_picture(const std::filesystem::path& file, const Transfer& transfer);

}  // namespace kdray::image
