// What    Pictures as a display shows them, and where two differ.
// Shape   Linear RGB in [0, 1]: brighter is shown as 1, since what is too bright for a display would outweigh
//         all else.
#pragma once

#include "io/image/image.h"
#include "kdray/kdray.h"

namespace kdray::bench {

image::Image image_of(const Picture& picture);

image::Image shown(image::Image image);

// The mean of each `factor` x `factor` pixels; the sides are multiples of it.
image::Image shrunk(const image::Image& image, int factor);

image::Image mean_of(image::Image a, const image::Image& b);

// The errors on the same scale for all pictures: a heat map of the square root of the largest channel's
// difference, so that 1/255 is visible (6% of the scale) and 1 is the hottest.
image::Image error_picture(const image::Image& reference, const image::Image& image);

}  // namespace kdray::bench
