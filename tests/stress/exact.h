// What    Rays and primitives in exact arithmetic: the oracle of the stress suite.
// Shape   Floats are sums of powers of two and so are their sums and products: with 1024 bits of mantissa all
//         of those are exact for coordinates of 1e-12 to 1e12, and what is not (quotients, roots) is right to
//         some 300 digits.
// Source  GMP's mpf.
#pragma once

#include <gmpxx.h>

#include <array>
#include <optional>
#include <vector>

#include "base/vec.h"
#include "layout/kinds.h"
#include "layout/primitives.layout.h"

namespace kdray::stress {

using Exact = mpf_class;  // with set_precision() called before the first is made
void set_precision();

struct Exact3 {
  Exact x, y, z;
};
Exact3 exactly(const float (&v)[3]);

// All t where the line meets the primitive as stored, negative ones too.
#define KDRAY_ROOTS_OF_KIND(NAME, name, names, Struct) \
  std::vector<Exact> roots(const Exact3& origin, const Exact3& direction, const layout::Struct& name);
KDRAY_KINDS(KDRAY_ROOTS_OF_KIND)
#undef KDRAY_ROOTS_OF_KIND
// The same of the cone carried on at both ends, by this share of its height.
std::vector<Exact> roots_past_the_ends(const Exact3& origin, const Exact3& direction,
                                       const layout::Cone& cone, double share);

// The distance from the surface's plane, sphere, cone or torus; of the last three with its sign: negative
// inside. (A kind that lacks one does not link.)
#define KDRAY_DISTANCE_OF_KIND(NAME, name, names, Struct) \
  double distance(const Exact3& point, const layout::Struct& name);
KDRAY_KINDS(KDRAY_DISTANCE_OF_KIND)
#undef KDRAY_DISTANCE_OF_KIND

// |approximate - exact| in units of the last place of a float of `scale`'s size.
double ulps(double approximate, const Exact& exact, double scale);
double ulp(double scale);

}  // namespace kdray::stress
