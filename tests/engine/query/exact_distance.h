// What    How far a point is from a primitive as the kernels have it, in exact arithmetic: the oracle of
//         closest points.
// Shape   From the definition of each kind's surface, not by the kernels' formulas. Sums and products of
//         GMP's floats are exact with 1536 bits for coordinates of 2^-100 to 2^40; quotients and roots are
//         right to 400 digits.
#pragma once

#include "base/vec.h"
#include "layout/kinds.h"
#include "layout/primitives.layout.h"
#include "oracle/exact_vec.h"

namespace kdray::test {

// Before the first is made.
inline void set_exact_precision() {
  mpf_set_default_prec(1536);
}

// Each kind has both (tests/primitives/<kind>.cpp, which defines distance<N>()). The rough ones are right to
// 2^-60 of the largest coordinate, in long double: to find which primitives are worth an exact answer.
#define KDRAY_DISTANCES_OF_KIND(NAME, name, names, Struct)              \
  Exact exact_distance(const dvec3& point, const layout::Struct& name); \
  long double rough_distance(const dvec3& point, const layout::Struct& name);
KDRAY_KINDS(KDRAY_DISTANCES_OF_KIND)
#undef KDRAY_DISTANCES_OF_KIND
#define KDRAY_DEFINE_DISTANCES(Struct)                                              \
  Exact exact_distance(const dvec3& point, const layout::Struct& primitive) {       \
    return distance<Exact>(point, primitive);                                       \
  }                                                                                 \
  long double rough_distance(const dvec3& point, const layout::Struct& primitive) { \
    return distance<long double>(point, primitive);                                 \
  }

}  // namespace kdray::test
