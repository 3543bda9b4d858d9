// What    Pictures made of others, and the decoders of the pictures of textures: PNG and, where kdray was
//         built with libjpeg-turbo and libwebp, JPEG and WebP; told by their first bytes.
// Shape   Eight bits for each of red, green, blue and alpha, whatever the file has: 16 bits are rounded, grey
//         and palettes widened, CMYK turned into RGB as its inks say. Colour profiles are left alone, as glTF
//         asks for.
// Errors  kdray::Error, ErrorCode::input, in one line: another format, a damaged file, more texels than
//         kMostTexels or a side longer than kLongestSide, told by the header before anything is allocated. A
//         JPEG that is cut short is taken as far as it goes, with a warning.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
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

// ---- Pictures that are made of others, since a map is one picture where a file has two. Heights and alpha
// are bytes, from 0 to 255.

// Returns whether red, green and blue are the same everywhere.
bool is_grey(const Picture& picture);

// Returns the normals of the relief whose heights a grey picture shows: where neighbours differ by 255 it is
// as steep as `strength`, from the middle of the two neighbours' difference along each axis. The picture
// repeats.
std::shared_ptr<const Picture> normals_of_heights(const Picture& heights, double strength);

// Returns `colors` (white of the same size where there are none) with the alpha of `alpha`: its alpha channel
// where it has one, or else its red. Where the sizes differ, the nearest texel counts.
std::shared_ptr<const Picture> with_alpha(const Picture* colors, const Picture& alpha);

// Returns whether every texel is either wholly opaque or wholly transparent.
bool is_cut_out(const Picture& picture);

}  // namespace kdray::scene
