// What    Random numbers that are the same everywhere: the standard's engine, and our own distributions.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "base/vec.h"

namespace kdray::verify {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // [0, 1)
  double between(double lo, double hi) { return lo + (hi - lo) * unit(); }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  dvec3 direction() {
    const double z = between(-1, 1), angle = between(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace kdray::verify
