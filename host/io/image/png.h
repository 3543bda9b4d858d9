// What    PNG to and from memory, through libpng.
// Shape   PngPixels.samples: rows from the top, `channels` per pixel, each 0 .. 2^bits - 1. The callers
//         choose PngMeta::color: for pictures encode_color() in picture_file.cpp.
// Errors  encode_png: kdray::Error internal. decode_png: kdray::Error input, naming `file`.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kdray::image {

struct PngPixels {
  int width = 0, height = 0;
  int channels = 3;  // 1: grey, 3: RGB, 4: RGB and alpha, by which RGB is not multiplied
  int bits = 8;      // 8 or 16
  std::vector<std::uint16_t> samples;
};

// What a PNG says about its numbers: sRGB, a gamma (gAMA chunk), or nothing for data that is no colour.
enum class PngColor { srgb, gamma, data };

struct PngMeta {
  PngColor color = PngColor::data;
  double gamma = 1;     // PngColor::gamma: samples = linear^(1/gamma)
  std::string comment;  // a tEXt chunk "Comment"; empty: none
};

std::string encode_png(const PngPixels& picture, const PngMeta& meta);

// Palette, grey below 8 bits and grey itself become RGB; alpha stays; 16 bits stay 16.
PngPixels decode_png(std::string_view bytes, const std::string& file);

}  // namespace kdray::image
