// What    The picture that errors are measured from: many stratified samples, depth 16, every weight, in
//         double where the device computes in it; and how far it may be off itself.
// Shape   The mean of two pictures with half of the samples each, one of twice the frame's sides and one of
//         four times, shrunk. Samples are scattered by the number of their pixel, so the two have nothing in
//         common, and half of their RMSE is what the mean is off; nor have they anything in common with the
//         pictures that are judged.
#pragma once

#include "io/image/image.h"
#include "kdray/kdray.h"

namespace kdray::bench {

struct Reference {
  image::Image image;
  double own_error = 0;  // RMSE, estimated
  double seconds = 0;    // to render it
};

inline constexpr int kReferenceStep = 32;  // `samples` is a multiple of this

Reference make_reference(Renderer& renderer, int width, int height, int samples, Precision precision);

}  // namespace kdray::bench
