// What    Random numbers that are the same everywhere, for scenes and rays: the standard's distributions may
//         differ from library to library.
// Source  Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014: splitmix64.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/vec.h"

namespace kdray::generate {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  // Returns a number in [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double between(double lo, double hi) { return lo + (hi - lo) * unit(); }
  dvec3 in_box(const dvec3& lo, const dvec3& hi) {
    const double x = between(lo.x, hi.x), y = between(lo.y, hi.y), z = between(lo.z, hi.z);
    return {x, y, z};
  }

  // Uniform on the unit sphere.
  dvec3 direction() {
    const double z = between(-1, 1), phi = between(0, 2 * std::numbers::pi);
    const double across = std::sqrt(1 - z * z);
    return {across * std::cos(phi), across * std::sin(phi), z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace kdray::generate
