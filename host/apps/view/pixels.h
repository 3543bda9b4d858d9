// What    What a page is shown of a picture: the colours, or the channel that was asked for, as the files
//         have it that `kdray render` writes.
#pragma once

#include <string>

#include "kdray/kdray.h"

namespace kdray::view {

std::string as_jpeg(const Picture& picture, const RenderOptions& options, bool at_rest);

// Byte for byte the file.
std::string as_png(const Picture& picture, const RenderOptions& options);

}  // namespace kdray::view
