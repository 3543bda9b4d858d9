// What    Points as GMP's rationals, which tests of doubles compare answers with.
#pragma once

#include <gmpxx.h>

#include <array>

namespace kdray::test {

using Point = std::array<double, 3>;
using Exact = std::array<mpq_class, 3>;

inline Exact exact(const Point& p) {
  return {mpq_class(p[0]), mpq_class(p[1]), mpq_class(p[2])};
}

inline Exact minus(const Exact& a, const Exact& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

// Returns a*(b x c).
inline mpq_class volume(const Exact& a, const Exact& b, const Exact& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

}  // namespace kdray::test
