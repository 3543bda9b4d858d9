// What    Pictures as JPEG, for the way to a page: quick and small while something moves, nearly without loss
//         at rest.
// Errors  kdray::Error, ErrorCode::internal.
#pragma once

#include <span>
#include <string>

#include "io/image/png.h"
#include "kdray/kdray.h"

namespace kdray::view {

struct JpegOptions {
  int quality = 80;
  bool full_color = false;  // each pixel has its own colour (4:4:4), or four share one (4:2:0)
};

// Through sRGB's curve, by a table: within half a code of what a PNG has.
std::string encode_jpeg(const Picture& picture, const JpegOptions& options);
std::string encode_jpeg(const image::PngPixels& pixels, const JpegOptions& options);

}  // namespace kdray::view
