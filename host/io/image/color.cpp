#include "io/image/color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace kdray::image {

void check(const Transfer& transfer) {
  if (!transfer.srgb && !(transfer.gamma > 0 && std::isfinite(transfer.gamma)))
    throw Error(ErrorCode::usage, "gamma must be a positive number; 1 is linear, 2.2 a common screen");
}

double encode(const Transfer& transfer, double linear) {
  if (!transfer.srgb) return transfer.gamma == 1 ? linear : std::pow(linear, 1 / transfer.gamma);
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double decode(const Transfer& transfer, double display) {
  if (!transfer.srgb) return transfer.gamma == 1 ? display : std::pow(display, transfer.gamma);
  return display <= 0.04045 ? display / 12.92 : std::pow((display + 0.055) / 1.055, 2.4);
}

Quantizer::Quantizer(const Transfer& transfer, std::uint32_t maximum)
    : maximum_(maximum), begin_(maximum), bucket_code_(kBuckets + 1) {
  check(transfer);
  for (std::uint32_t code = 0; code < maximum; ++code) {
    const double exact = decode(transfer, (code + 0.5) / maximum);
    // It is rounded up, since the first float at or above the exact boundary is the first that gets the next
    // code.
    const float rounded = static_cast<float>(exact);
    begin_[code] =
        rounded < exact ? std::nextafter(rounded, std::numeric_limits<float>::infinity()) : rounded;
  }
  std::uint32_t code = 0;
  for (std::uint32_t b = 0; b <= kBuckets; ++b) {
    while (code < maximum && begin_[code] <= static_cast<float>(b) / kBuckets) ++code;
    bucket_code_[b] = code;
  }
}

std::uint32_t Quantizer::operator()(float linear) const {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return maximum_;
  const auto bucket = static_cast<std::uint32_t>(linear * kBuckets);  // exact: kBuckets is a power of two
  const float* first = begin_.data() + bucket_code_[bucket];
  const float* last = begin_.data() + bucket_code_[bucket + 1];
  return static_cast<std::uint32_t>(std::upper_bound(first, last, linear) - begin_.data());
}

vec3 heat(double share) {
  // Display values at equal steps, interpolated linearly as the eye sees them.
  static constexpr std::array<std::array<double, 3>, 6> kStops = {{{0, 0, 0},
                                                                   {0.20, 0.06, 0.48},
                                                                   {0.60, 0.14, 0.52},
                                                                   {0.90, 0.32, 0.36},
                                                                   {0.99, 0.65, 0.35},
                                                                   {0.99, 0.99, 0.80}}};
  const double position = (share > 0 ? std::min(share, 1.0) : 0.0) * (kStops.size() - 1);
  const std::size_t below = std::min<std::size_t>(static_cast<std::size_t>(position), kStops.size() - 2);
  const double part = position - static_cast<double>(below);
  const Transfer srgb{};
  vec3 color;
  for (int c = 0; c < 3; ++c)
    color[c] =
        static_cast<float>(decode(srgb, kStops[below][c] + part * (kStops[below + 1][c] - kStops[below][c])));
  return color;
}

namespace {

constexpr std::array<std::array<std::uint8_t, 3>, 7> kFirst = {{{230, 159, 0},
                                                                {86, 180, 233},
                                                                {0, 158, 115},
                                                                {204, 121, 167},
                                                                {240, 228, 66},
                                                                {0, 114, 178},
                                                                {213, 94, 0}}};

// Returns the colour of a hue from 0 to 1, `chroma` away from grey.
std::array<std::uint8_t, 3> of_hue(double hue, double chroma, double brightness) {
  std::array<std::uint8_t, 3> color{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double from_peak =
        std::abs(std::fmod(hue + static_cast<double>(k) / 3, 1.0) - 0.5) * 6;  // 0 at the channel's peak
    const double share = std::clamp(2 - from_peak, 0.0, 1.0);
    color[k] = static_cast<std::uint8_t>(std::lround(255 * brightness * (1 - chroma * (1 - share))));
  }
  return color;
}

}  // namespace

std::array<std::uint8_t, 3> queue_color(std::size_t queue) {
  if (queue < kFirst.size()) return kFirst[queue];
  // Steps of the golden section never come back to where they were, and neighbours are far apart.
  constexpr double kGoldenSection = 0.6180339887498949;
  const double number = static_cast<double>(queue - kFirst.size());
  return of_hue(std::fmod(number * kGoldenSection, 1.0), queue % 2 == 0 ? 0.55 : 0.85,
                queue % 3 == 0 ? 0.75 : 0.95);
}

}  // namespace kdray::image
