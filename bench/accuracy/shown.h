// What    Pictures as a display shows them, the one that errors are measured from, and where two differ.
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

struct Reference {
  image::Image image;
  double own_error = 0;  // RMSE, estimated
  double seconds = 0;    // to render it
};

inline constexpr int kReferenceStep = 32;  // `samples` is a multiple of this

// Many stratified samples, depth 16, every weight: the mean of two pictures with half of the samples each,
// one of twice the frame's sides and one of four times, shrunk. Samples are scattered by the number of their
// pixel, so the two have nothing in common, and half of their RMSE is what the mean is off; nor have they
// anything in common with the pictures that are judged.
Reference make_reference(Renderer& renderer, int width, int height, int samples, Precision precision);

// The errors on the same scale for all pictures: a heat map of the square root of the largest channel's
// difference, so that 1/255 is visible (6% of the scale) and 1 is the hottest.
image::Image error_picture(const image::Image& reference, const image::Image& image);

}  // namespace kdray::bench
