#include "film/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "film/flip.h"
#include "film/heat.h"

namespace kdray::film {
namespace {

void check_sizes(const Image& a, const Image& b) {
  const auto size = [](const Image& i) { return std::to_string(i.width) + " x " + std::to_string(i.height); };
  if (a.width != b.width || a.height != b.height)
    throw Error(ErrorCode::input, "the pictures differ in size: " + size(a) + " and " + size(b) +
                                      "; render them with the same --size");
}

// Equal infinities and two NaNs are no difference; a NaN against a number is an infinite one, so that no sum
// or comparison can lose it.
double difference(float a, float b) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
  const double d = std::abs(static_cast<double>(a) - b);
  return std::isnan(d) ? std::numeric_limits<double>::infinity() : d;
}

double largest_difference(const vec3& a, const vec3& b) {
  return std::max({difference(a.x, b.x), difference(a.y, b.y), difference(a.z, b.z)});
}

}  // namespace

Difference compare(const Image& a, const Image& b) {
  check_sizes(a, b);
  // A step of an 8-bit linear picture is no difference yet, however its floats were rounded.
  constexpr double kStep = 1.0 / 255 + 1e-6;
  Difference result;
  double squares = 0, sum = 0;
  std::size_t n_differing = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double d = difference(a.pixels[i][c], b.pixels[i][c]);
      squares += d * d, sum += d;
    }
    const double largest = largest_difference(a.pixels[i], b.pixels[i]);
    result.max = std::max(result.max, largest);
    n_differing += largest > kStep;
  }
  const double n_pixels = std::max<double>(1, static_cast<double>(a.pixels.size()));
  result.rmse = std::sqrt(squares / (3 * n_pixels));
  result.mean_absolute = sum / (3 * n_pixels);
  result.differing_share = static_cast<double>(n_differing) / n_pixels;
  result.flip = mean_flip(a, b);
  return result;
}

Image difference_image(const Image& a, const Image& b) {
  check_sizes(a, b);
  std::vector<double> differences(a.pixels.size());
  double scale = 0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    differences[i] = largest_difference(a.pixels[i], b.pixels[i]);
    if (std::isfinite(differences[i])) scale = std::max(scale, differences[i]);
  }
  Image image{a.width, a.height, {}};
  image.pixels.reserve(differences.size());
  for (double d : differences) image.pixels.push_back(heat(d > 0 ? (scale > 0 ? d / scale : 1) : 0));
  return image;
}

}  // namespace kdray::film
