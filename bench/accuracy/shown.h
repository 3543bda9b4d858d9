// What    Pictures as a display shows them, and where two differ.
// Shape   Linear RGB in [0, 1]: brighter is shown as 1, since what is too bright for a display would outweigh
//         all else.
#pragma once

#include "io/image/image.h"
#include "kdray/kdray.h"

namespace kdray::bench {

film::Image image_of(const Picture& picture);

film::Image shown(film::Image image);

// The mean of each `factor` x `factor` pixels; the sides are multiples of it.
film::Image shrunk(const film::Image& image, int factor);

film::Image mean_of(film::Image a, const film::Image& b);

// The errors on the same scale for all pictures: a heat map of the square root of the largest channel's
// difference, so that 1/255 is visible (6% of the scale) and 1 is the hottest.
film::Image error_picture(const film::Image& reference, const film::Image& image);

}  // namespace kdray::bench
