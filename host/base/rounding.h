// What    Rounding to float in a stated direction: bounds computed in double become floats that still contain
//         them.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

namespace kdray {

// The next float towards -infinity; -infinity stays.
inline float next_below(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  if (x == 0) return -std::numeric_limits<float>::denorm_min();
  if (x == -std::numeric_limits<float>::infinity()) return x;
  return std::bit_cast<float>(x > 0 ? bits - 1 : bits + 1);
}

// The largest float <= x, the smallest float >= x.
inline float round_down(double x) {
  const auto f = static_cast<float>(x);
  return f > x ? next_below(f) : f;
}
inline float round_up(double x) {
  return -round_down(-x);
}

}  // namespace kdray
