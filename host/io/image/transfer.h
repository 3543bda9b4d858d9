// What    Transfer curves between linear values and PNG's integers, and the quantiser that applies one
//         exactly.
// Shape   Curves map [0, 1] to [0, 1] and grow strictly.
// Errors  kdray::Error, ErrorCode::usage: a gamma that is not a positive number.
// Source  IEC 61966-2-1 (sRGB): 12.92 v below 0.0031308, else 1.055 v^(1/2.4) - 0.055.
#pragma once

#include <cstdint>
#include <vector>

#include "io/image/write.h"

namespace kdray::image {

double encode(const Transfer& transfer, double linear);   // linear -> display
double decode(const Transfer& transfer, double display);  // display -> linear
void check(const Transfer& transfer);

// Rounds encode(v) * maximum to nearest. Built once per picture: it holds the linear value at which each code
// begins, so that a pixel costs a short search instead of a power, and the result does not depend on a
// float's rounding.
class Quantizer {
 public:
  Quantizer(const Transfer& transfer, std::uint32_t maximum);  // maximum: 255 or 65535

  // The result is clamped to [0, maximum]; NaN gives 0.
  std::uint32_t operator()(float linear) const;

 private:
  static constexpr std::uint32_t kBuckets = 4096;
  std::uint32_t maximum_;
  std::vector<float> begin_;                // begin_[k]: the smallest float that gives code k + 1
  std::vector<std::uint32_t> bucket_code_;  // the code of the value b / kBuckets, b = 0 .. kBuckets
};

}  // namespace kdray::image
