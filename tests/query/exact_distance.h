// What    How far a point is from a primitive as the kernels have it, in exact arithmetic: the oracle of
//         closest points.
// Shape   From the definition of each kind's surface, not by the kernels' formulas. Sums and products of
//         GMP's floats are exact with 1536 bits for coordinates of 2^-100 to 2^40; quotients and roots are
//         right to 400 digits.
#pragma once

#include <gmpxx.h>

#include "layout/kinds.h"
#include "layout/primitives.layout.h"
#include "math/vec.h"

namespace kdray::test {

using Exact = mpf_class;
void set_exact_precision();  // before the first is made

Exact exact_distance(const dvec3& point, const layout::Triangle& triangle);
Exact exact_distance(const dvec3& point, const layout::Sphere& sphere);
Exact exact_distance(const dvec3& point, const layout::Cone& cone);
Exact exact_distance(const dvec3& point, const layout::Disc& disc);

// The same to 2^-60 of the largest coordinate, in long double: to find which primitives are worth an exact
// answer.
long double rough_distance(const dvec3& point, const layout::Triangle& triangle);
long double rough_distance(const dvec3& point, const layout::Sphere& sphere);
long double rough_distance(const dvec3& point, const layout::Cone& cone);
long double rough_distance(const dvec3& point, const layout::Disc& disc);

}  // namespace kdray::test
