// What    Reads PNG (8/16 bit, grey, RGB, with or without alpha, palette) and EXR back into linear RGB, with
//         alpha where they have it, for comparison. PNG values go through `transfer` backwards; a linear PNG
//         wants {.srgb = false, .gamma = 1}.
#pragma once

#include <filesystem>

#include "io/image/image.h"
#include "io/image/write.h"

namespace kdray::image {

Image read_picture(const std::filesystem::path& file, const Transfer& transfer);

}  // namespace kdray::image
