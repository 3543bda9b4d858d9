// What    The FLIP difference of two pictures as a viewer sees them when one is flipped against the other.
// Shape   Linear RGB, row by row; values are clamped to the display's range [0, 1], NaN to 0.
// Units   errors in [0, 1]; pixels per degree of visual angle (67: a 0.7 m wide 4K screen from 0.7 m).
// Source  Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astrom, Fairchild: "FLIP: A Difference Evaluator
//         for Alternating Images", HPG 2020 (the LDR metric). Its filters are sums of Gaussians and their
//         derivatives, so here each is applied as rows and columns, which the paper leaves open.
#pragma once

#include <vector>

#include "io/image/image.h"

namespace kdray::image {

constexpr double kPixelsPerDegree = 67;

// Returns the error of each pixel; the sizes must be equal.
std::vector<float> flip_map(const Image& reference, const Image& test,
                            double pixels_per_degree = kPixelsPerDegree);
double mean_flip(const Image& reference, const Image& test, double pixels_per_degree = kPixelsPerDegree);

// The parts of the metric are declared for its tests.
namespace flip {
dvec3 ycxcz(const dvec3& linear_rgb);
dvec3 linear_rgb(const dvec3& ycxcz);
dvec3 hunt_lab(const dvec3& linear_rgb);      // L*a*b* with chroma scaled by lightness (Hunt effect)
double hyab(const dvec3& a, const dvec3& b);  // |dL| + the length of (da, db)
double redistribute(double hyab_to_the_07);   // to [0, 1]; the largest distance (green, blue) gives 1
double largest_color_distance();              // of green and blue, to the power 0.7
}  // namespace flip

}  // namespace kdray::image
