// What    What a page is shown of a picture: the colours, or the channel that was asked for. As JPEG, quick
//         and small while something moves and nearly without loss at rest; as PNG like the file that `kdray
//         render` writes.
// Errors  kdray::Error, ErrorCode::internal.
#pragma once

#include <string>

#include "kdray/kdray.h"

namespace kdray::view {

std::string as_jpeg(const Picture& picture, const RenderOptions& options, bool at_rest);

// Returns the bytes of the file that `kdray render` would write.
std::string as_png(const Picture& picture, const RenderOptions& options);

}  // namespace kdray::view
