#include "io/image/transfer.h"

#include <algorithm>
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

}  // namespace kdray::image
