// What    Random numbers by counter: the i-th number of a stream depends on its seed and i alone, so that
//         rays can be made by any number of threads and a failing one named by its number.
// Source  SplitMix64: Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/vec.h"

namespace kdray::stress {

class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t number)
      : state_(mixed(seed * 0x9e3779b97f4a7c15u + mixed(number + 1))) {}

  std::uint64_t bits() { return mixed(state_ += 0x9e3779b97f4a7c15u); }
  std::uint32_t below(std::size_t n) {
    return static_cast<std::uint32_t>(((bits() >> 32) * static_cast<std::uint64_t>(n)) >> 32);
  }
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  double sign() { return bits() >> 63 ? 1.0 : -1.0; }
  // Every order of magnitude is as likely as the others.
  double log_uniform(double lo, double hi) { return lo * std::pow(hi / lo, uniform()); }
  double signed_log_uniform(double lo, double hi) { return sign() * log_uniform(lo, hi); }

  dvec3 direction() {
    const double z = uniform(-1, 1), phi = uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
  // Weights of the corners that spread points evenly over a triangle.
  dvec3 weights() {
    double u = uniform(), v = uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    return {1 - u - v, u, v};
  }

 private:
  static std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

}  // namespace kdray::stress
