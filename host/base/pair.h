// What    A number as the sum of two doubles, the second below the first one's last place: some 106 bits.
// Shape   Computes as a double does: sums, products, quotients and square roots, comparisons, min, max.
// Errors  Sums are off by 2^-104 of themselves, products by 2^-103, quotients and roots by 2^-101, where
//         neither the numbers nor what is left of their products underflow: from 2^-400 to 2^400.
// Source  Dekker 1971; Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of
//         double-word arithmetic", 2017.
#pragma once

#include <cmath>
#include <compare>

namespace kdray {

struct Pair {
  double high, low;

  Pair() = default;
  constexpr Pair(double h, double l = 0) : high(h), low(l) {}
  explicit operator double() const { return high; }

  Pair operator-() const { return {-high, -low}; }
  // NaN is in no order.
  std::partial_ordering operator<=>(const Pair& other) const {
    return high != other.high ? high <=> other.high : low <=> other.low;
  }
  bool operator==(const Pair& other) const { return high == other.high && low == other.low; }
};

// Exactly.
inline Pair exact_sum(double a, double b) {
  const double sum = a + b, back = sum - a;
  return {sum, (a - (sum - back)) + (b - back)};
}
inline Pair exact_product(double a, double b) {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}

inline Pair operator+(const Pair& a, const Pair& b) {
  const Pair high = exact_sum(a.high, b.high), low = exact_sum(a.low, b.low);
  const Pair sum = exact_sum(high.high, high.low + low.high);
  return exact_sum(sum.high, sum.low + low.low);
}
inline Pair operator-(const Pair& a, const Pair& b) {
  return a + -b;
}
inline Pair operator*(const Pair& a, const Pair& b) {
  const Pair product = exact_product(a.high, b.high);
  return exact_sum(product.high, product.low + std::fma(a.high, b.low, a.low * b.high));
}
inline Pair operator/(const Pair& a, const Pair& b) {
  const double about = a.high / b.high;
  const Pair left = a - b * about;
  return exact_sum(about, left.high / b.high);
}
inline Pair& operator+=(Pair& a, const Pair& b) {
  return a = a + b;
}

inline Pair sqrt(const Pair& a) {
  const double about = std::sqrt(a.high);
  if (!(about > 0)) return about;
  const Pair left = a - exact_product(about, about);
  return exact_sum(about, left.high / (2 * about));
}
inline Pair abs(const Pair& a) {
  return a.high < 0 ? -a : a;
}
inline Pair copysign(const Pair& size, const Pair& sign) {
  return std::signbit(size.high) == std::signbit(sign.high) ? size : -size;
}

}  // namespace kdray
