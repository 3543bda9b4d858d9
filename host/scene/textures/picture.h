// What    Decodes the pictures of textures: PNG and, where kdray was built with libjpeg-turbo and libwebp,
//         JPEG and WebP; told by their first bytes.
// Shape   Eight bits for each of red, green, blue and alpha, whatever the file has: 16 bits are rounded, grey
//         and palettes widened, CMYK turned into RGB as its inks say. Colour profiles are left alone, as glTF
//         asks for.
// Errors  kdray::Error, ErrorCode::input, in one line: another format, a damaged file, more texels than
//         kMostTexels or a side longer than kLongestSide, told by the header before anything is allocated. A
//         JPEG that is cut short is taken as far as it goes, with a warning.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scene/textures/texturing.h"

namespace kdray::scene {

// Kernels count 256ths of a texel in floats, which hold 2^23 without loss: a mirrored side of this.
inline constexpr std::uint32_t kLongestSide = 16384;
inline constexpr std::size_t kMostTexels = std::size_t{1} << 26;

std::shared_ptr<const Picture> decode_picture(std::string_view bytes, const std::string& name,
                                              std::vector<std::string>& warnings);

}  // namespace kdray::scene
