// What    Writes pictures: PNG (8 or 16 bit, through a transfer curve) and EXR (float, linear). Every file is
//         written whole or not at all: beside it first, then renamed (base/write_file.h).
// Errors  kdray::Error, ErrorCode::input: not writable, disk full, unknown ending.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "base/write_file.h"
#include "film/image.h"

namespace kdray::film {

using kdray::write_atomically;

// How linear values become PNG's integers: sRGB's curve, or v^(1/gamma); 1 is linear.
struct Transfer {
  bool srgb = true;
  double gamma = 2.2;  // used when !srgb
};

struct WriteOptions {
  Transfer transfer;
  int png_bits = 8;  // 8 or 16
};

struct Written {
  std::vector<std::filesystem::path> files;  // the picture first
  std::size_t nan_values = 0;                // of the colour: 0 in a PNG, kept in an EXR
};

// The ending of `file`, .png or .exr, decides the format. Channels go into the EXR itself ("Z", "N.X" "N.Y"
// "N.Z", "primitive", "cost"), or beside a PNG as NAME.depth.png (16 bit grey, near white to far black,
// background black), NAME.normal.png (8 bit, 0.5 + 0.5*n), NAME.primitive.png (a colour for each number),
// NAME.cost.png (a heat map).
Written write_picture(const std::filesystem::path& file, const Image& image,
                      std::span<const Channel> channels, const WriteOptions& options);

// Throws what write_picture would throw for this name, so that a wrong one is found before the picture is
// rendered.
void check_picture_name(const std::filesystem::path& file);

}  // namespace kdray::film
