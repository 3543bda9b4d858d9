// What    How far a point is from a primitive as the kernels have it, in exact arithmetic: the oracle of
//         closest points.
// Shape   From the definition of each kind's surface, not by the kernels' formulas. Sums and products of
//         GMP's floats are exact with 1536 bits for coordinates of 2^-100 to 2^40; quotients and roots are
//         right to 400 digits.
#pragma once

#include <gmpxx.h>

#include "base/vec.h"
#include "layout/kinds.h"
#include "layout/primitives.layout.h"

namespace kdray::test {

using Exact = mpf_class;
void set_exact_precision();  // before the first is made

// Each kind has both. The rough ones are right to 2^-60 of the largest coordinate, in long double: to find
// which primitives are worth an exact answer.
#define KDRAY_DISTANCES_OF_KIND(NAME, name, names, Struct)              \
  Exact exact_distance(const dvec3& point, const layout::Struct& name); \
  long double rough_distance(const dvec3& point, const layout::Struct& name);
KDRAY_KINDS(KDRAY_DISTANCES_OF_KIND)
#undef KDRAY_DISTANCES_OF_KIND

}  // namespace kdray::test
