// What    Writes pictures: PNG (8 or 16 bit, through a transfer curve) and EXR (float, linear). Every file is
//         written whole or not at all: beside it first, then renamed (base/write_file.h).
// Errors  kdray::Error, ErrorCode::input: not writable, disk full, unknown ending.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/write_file.h"
#include "io/image/format.h"
#include "io/image/image.h"

namespace kdray::image {

using kdray::write_atomically;

// How linear values become PNG's integers: sRGB's curve, or v^(1/gamma); 1 is linear.
struct Transfer {
  bool srgb = true;
  double gamma = 2.2;  // used when !srgb
};

struct WriteOptions {
  Transfer transfer;
  int png_bits = 8;                          // 8 or 16
  std::optional<PictureFormat> format = {};  // none: by the ending of the file's name
};

struct Written {
  std::vector<std::filesystem::path> files;  // the picture first
  std::size_t nan_values = 0;                // of the colour: 0 in a PNG, kept in an EXR
};

// Channels go into the EXR itself ("Z", "N.X" "N.Y"
// "N.Z", "primitive", "cost"), or beside a PNG as NAME.depth.png (16 bit grey, near white to far black,
// background black), NAME.normal.png (8 bit, 0.5 + 0.5*n), NAME.primitive.png (a colour for each number),
// NAME.cost.png (a heat map).
Written write_picture(const std::filesystem::path& file, const Image& image,
                      std::span<const Channel> channels, const WriteOptions& options);

// Values of the colour that are not numbers.
std::size_t count_nan(const Image& image);

// The bytes of such a file, without the channels that a PNG has beside it.
std::string encode_picture(PictureFormat format, const Image& image, std::span<const Channel> channels,
                           const WriteOptions& options);

// The files that write_picture would write with these channels ("normal" for the three of a normal), the
// picture first. Throws for a name whose ending tells no format.
std::vector<std::filesystem::path> picture_files(const std::filesystem::path& file,
                                                 std::span<const std::string> channels,
                                                 const WriteOptions& options);

}  // namespace kdray::image
