// What    Decodes WebP pictures, which glTF has by EXT_texture_webp, where kdray was built with libwebp.
// Shape   As picture.h has it; of an animation there is none, it is refused.
// Errors  kdray::Error, ErrorCode::input, in one line: a damaged file, more pixels than its bytes may hold
//         (kMostPixelsPerByte, or kMostPixelsOfSmall), a kdray without libwebp.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "scene/textures/texturing.h"

namespace kdray::scene {

// An evenly coloured picture takes nearly nothing.
inline constexpr std::uint64_t kMostPixelsPerByte = 8192, kMostPixelsOfSmall = std::uint64_t{1} << 24;

bool is_webp(std::string_view bytes);

// `check_size` refuses a width and a height that no picture may have, before anything is allocated.
Picture decode_webp(std::string_view bytes, const std::string& name,
                    void (*check_size)(std::uint64_t width, std::uint64_t height, const std::string& name));

}  // namespace kdray::scene
