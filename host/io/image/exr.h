// What    OpenEXR to and from memory: 32-bit float scan lines, ZIP compressed (lossless), any channels.
// Errors  decode_exr: kdray::Error, ErrorCode::input, naming `file`.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "io/image/image.h"

namespace kdray::image {

// Writes what is a part of a picture as such: the data window within the whole's display window. Writes the
// colour as R, G and B, its alpha as A where it has one, `channels` under the names that they have
// in an EXR (exr_name), and the manifests of those that have one as attributes, "kdray/CHANNEL/manifest".
std::string encode_exr(const Image& image, std::span<const Channel> channels);

// Reads R, G and B, or grey from Y alone, and A as alpha. The picture is the file's data window; other
// channels are skipped. More than `most` pixels are refused before they are read.
Image decode_exr(std::string_view bytes, const std::string& file, std::uint64_t most = ~std::uint64_t{0});

// Returns a channel's name in an EXR: "depth" becomes "Z", "normal.x" becomes "N.X"; others stay as they are.
std::string exr_name(const std::string& channel);

}  // namespace kdray::image
