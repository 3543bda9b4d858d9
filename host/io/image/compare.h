// What    How far two pictures are apart: RMSE, mean absolute and largest difference in linear RGB, share of
//         pixels that differ by more than 1/255 in some channel, and the mean FLIP error (Andersson et al.
//         2020, LDR, 67 pixels per degree). Where one of the pictures has alpha it is a fourth channel, of
//         which the other has 1, colours are multiplied with it, and FLIP is the larger one of over black and
//         over white.
// Errors  kdray::Error, ErrorCode::input, when the sizes differ.
#pragma once

#include <vector>

#include "io/image/image.h"

namespace kdray::image {

// The FLIP difference of two pictures as a viewer sees them when one is flipped against the other. Linear
// RGB, row by row; values are clamped to the display's range [0, 1], NaN to 0. errors in [0, 1]; pixels per
// degree of visual angle (67: a 0.7 m wide 4K screen from 0.7 m). Source: Andersson, Nilsson,
// Akenine-Moeller, Oskarsson, Astrom, Fairchild: "FLIP: A Difference Evaluator for Alternating Images", HPG
// 2020 (the LDR metric). Its filters are sums of Gaussians and their derivatives, so here each is applied
// as rows and columns, which the paper leaves open.
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

struct Difference {
  double rmse = 0, mean_absolute = 0, max = 0, differing_share = 0, flip = 0;
};

Difference compare(const Image& a, const Image& b);

// Returns the absolute difference per pixel as a heat map, scaled so that the largest difference is the
// hottest colour.
Image difference_image(const Image& a, const Image& b);

}  // namespace kdray::image
