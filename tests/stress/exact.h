// What    Rays and primitives in exact arithmetic: the oracle of the stress suite.
// Shape   Floats are sums of powers of two and so are their sums and products: with 1024 bits of mantissa all
//         of those are exact for coordinates of 1e-12 to 1e12, and what is not (quotients, roots) is right to
//         some 300 digits.
// Source  GMP's mpf.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/vec.h"
#include "layout/kinds.h"
#include "layout/primitives.layout.h"
#include "oracle/exact_vec.h"

namespace kdray::stress {

using test::Exact;
using Exact3 = test::Vec<Exact>;

// Before the first is made.
inline void set_precision() {
  mpf_set_default_prec(1024);
}
inline Exact3 exactly(const float (&v)[3]) {
  return test::vec<Exact>(v);
}

// Each kind has the following two (tests/primitives/<kind>.cpp). A kind that lacks one does not link.

// All t where the line meets the primitive as stored, negative ones too.
#define KDRAY_ROOTS_OF_KIND(NAME, name, names, Struct) \
  std::vector<Exact> roots(const Exact3& origin, const Exact3& direction, const layout::Struct& name);
KDRAY_KINDS(KDRAY_ROOTS_OF_KIND)
#undef KDRAY_ROOTS_OF_KIND
// The distance from the surface's plane, sphere, cone or torus; of the last three with its sign: negative
// inside.
#define KDRAY_DISTANCE_OF_KIND(NAME, name, names, Struct) \
  double distance(const Exact3& point, const layout::Struct& name);
KDRAY_KINDS(KDRAY_DISTANCE_OF_KIND)
#undef KDRAY_DISTANCE_OF_KIND

// The roots of a t^2 + 2 b t + c, ascending.
inline std::vector<Exact> quadratic(const Exact& a, const Exact& b, const Exact& c) {
  if (sgn(a) == 0) {
    if (sgn(b) == 0) return {};
    return {Exact(-c / (2 * b))};
  }
  const Exact discriminant = b * b - a * c;
  if (sgn(discriminant) < 0) return {};
  const Exact root = sqrt(discriminant), first = (-b - root) / a, second = (-b + root) / a;
  return first < second ? std::vector<Exact>{first, second} : std::vector<Exact>{second, first};
}

inline double ulp(double scale) {
  int exponent = 0;
  std::frexp(scale, &exponent);
  return std::ldexp(1.0, std::max(exponent - 24, -149));
}
// |approximate - exact| in units of the last place of a float of `scale`'s size.
inline double ulps(double approximate, const Exact& exact, double scale) {
  return std::abs(Exact(Exact(approximate) - exact).get_d()) / ulp(scale);
}

}  // namespace kdray::stress
