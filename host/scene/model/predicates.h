// What    On which side of the line a-b the point c lies in the plane, decided exactly.
// Shape   +1: left (a, b, c turn counter-clockwise), -1: right, 0: the three are on one line.
// Errors  None while no product of two coordinates overflows or falls below the normal range (about 1e-140 to
//         1e150, or 0); every float is inside that.
// Source  J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
//         predicates", 1997: the filter of orient2d (ccwerrboundA), then the exact sum of the six products as
//         an expansion.
#pragma once

#include <array>
#include <cmath>

#include "base/vec.h"

namespace kdray::scene {

using dvec2 = glm::dvec2;

namespace exact {

// A number as the exact sum of doubles that don't overlap, smallest first; zeros are left out. It can hold as
// many as are added.
template <int kCapacity>
class Expansion {
 public:
  void add(double value) {
    int kept = 0;
    for (int i = 0; i < size_; ++i) {
      const double sum = value + part_[i];
      const double back = sum - value;
      const double rest = (value - (sum - back)) + (part_[i] - back);
      if (rest != 0) part_[kept++] = rest;
      value = sum;
    }
    if (value != 0) part_[kept++] = value;
    size_ = kept;
  }
  void add_product(double a, double b) {
    const double high = a * b;
    add(std::fma(a, b, -high));
    add(high);
  }
  template <int kOther>
  void add_product(const Expansion<kOther>& a, double b) {
    for (const double part : a) add_product(part, b);
  }
  int sign() const { return size_ == 0 ? 0 : (part_[size_ - 1] > 0 ? 1 : -1); }
  const double* begin() const { return part_.data(); }
  const double* end() const { return part_.data() + size_; }

 private:
  std::array<double, kCapacity> part_;
  int size_ = 0;
};

inline int orient_sign(const dvec2& a, const dvec2& b, const dvec2& c) {
  // (b - a) x (c - a) multiplied out, so that no difference is rounded.
  Expansion<12> sum;
  sum.add_product(b.x, c.y);
  sum.add_product(-b.x, a.y);
  sum.add_product(-a.x, c.y);
  sum.add_product(-b.y, c.x);
  sum.add_product(b.y, a.x);
  sum.add_product(a.y, c.x);
  return sum.sign();
}

}  // namespace exact

// Returns 0 where doubles alone can't tell, as well.
inline int sure_orient_sign(const dvec2& a, const dvec2& b, const dvec2& c) {
  const double left = (b.x - a.x) * (c.y - a.y);
  const double right = (b.y - a.y) * (c.x - a.x);
  const double det = left - right;
  constexpr double kHalfUlp = 1.1102230246251565e-16;
  const double bound = (3 + 16 * kHalfUlp) * kHalfUlp * (std::abs(left) + std::abs(right));
  return (det > bound) - (det < -bound);
}

inline int orient_sign(const dvec2& a, const dvec2& b, const dvec2& c) {
  const int sure = sure_orient_sign(a, b, c);
  return sure != 0 ? sure : exact::orient_sign(a, b, c);
}

}  // namespace kdray::scene
