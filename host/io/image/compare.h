// What    How far two pictures are apart: RMSE, mean absolute and largest difference in linear RGB, share of
//         pixels that differ by more than 1/255 in some channel, and the mean FLIP error (Andersson et al.
//         2020, LDR, 67 pixels per degree). Where one of the pictures has alpha it is a fourth channel, of
//         which the other has 1, colours are multiplied with it, and FLIP is the larger one of over black and
//         over white.
// Errors  kdray::Error, ErrorCode::input, when the sizes differ.
#pragma once

#include "io/image/image.h"

namespace kdray::image {

struct Difference {
  double rmse = 0, mean_absolute = 0, max = 0, differing_share = 0, flip = 0;
};

Difference compare(const Image& a, const Image& b);

// Returns the absolute difference per pixel as a heat map, scaled so that the largest difference is the
// hottest colour.
Image difference_image(const Image& a, const Image& b);

}  // namespace kdray::image
