#include "io/image/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "io/image/color.h"

namespace kdray::image {
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

// The differences of a pixel: of red, green and blue, and of alpha where one of the pictures has it.
struct PixelDifference {
  double of[4] = {};
  double largest() const { return std::max({of[0], of[1], of[2], of[3]}); }
};

float alpha_of(const Image& image, std::size_t i) {
  return image.alpha.empty() ? 1.0f : image.alpha[i];
}

PixelDifference difference(const Image& a, const Image& b, std::size_t i) {
  const vec3 &p = a.pixels[i], &q = b.pixels[i];
  return {{difference(p.x, q.x), difference(p.y, q.y), difference(p.z, q.z),
           difference(alpha_of(a, i), alpha_of(b, i))}};
}

Image over_white(const Image& image) {
  Image over = image;
  for (std::size_t i = 0; i < over.pixels.size(); ++i) over.pixels[i] += vec3(1 - alpha_of(image, i));
  return over;
}

// With alpha: over black or over white, whichever shows more.
double flip_of(const Image& a, const Image& b) {
  const double over_black = mean_flip(a, b);
  if (a.alpha.empty() && b.alpha.empty()) return over_black;
  return std::max(over_black, mean_flip(over_white(a), over_white(b)));
}

}  // namespace

Difference compare(const Image& a, const Image& b) {
  check_sizes(a, b);
  // A step of an 8-bit linear picture is no difference yet, however its floats were rounded.
  constexpr double kStep = 1.0 / 255 + 1e-6;
  Difference result;
  double squares = 0, sum = 0;
  std::size_t n_differing = 0;
  const int n_values = a.alpha.empty() && b.alpha.empty() ? 3 : 4;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const PixelDifference d = difference(a, b, i);
    for (int c = 0; c < n_values; ++c) squares += d.of[c] * d.of[c], sum += d.of[c];
    const double largest = d.largest();
    result.max = std::max(result.max, largest);
    n_differing += largest > kStep;
  }
  const double n_pixels = std::max<double>(1, static_cast<double>(a.pixels.size()));
  result.rmse = std::sqrt(squares / (n_values * n_pixels));
  result.mean_absolute = sum / (n_values * n_pixels);
  result.differing_share = static_cast<double>(n_differing) / n_pixels;
  result.flip = flip_of(a, b);
  return result;
}

Image difference_image(const Image& a, const Image& b) {
  check_sizes(a, b);
  std::vector<double> differences(a.pixels.size());
  double scale = 0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    differences[i] = difference(a, b, i).largest();
    if (std::isfinite(differences[i])) scale = std::max(scale, differences[i]);
  }
  Image image{a.width, a.height, {}};
  image.pixels.reserve(differences.size());
  for (double d : differences) image.pixels.push_back(heat(d > 0 ? (scale > 0 ? d / scale : 1) : 0));
  return image;
}

}  // namespace kdray::image
