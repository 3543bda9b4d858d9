// What    What is certain about a ray and a shape, in double and with the error known: for `kdray verify`.
// Shape   Everything about the scene's centre, on the primitives as rays see them. Each shape's own part is
//         in <kind>_exact.cpp.
#pragma once

#include "math/vec.h"

namespace kdray::primitives {

struct Line {
  dvec3 origin, direction;
};

// Along a line a solid's surface is where a*t^2 + 2*b*t + c = 0; inside it is negative. A cone's is that of
// the whole double cone.
struct Quadratic {
  double a, b, c;
};

// Whether a hit at t is surely none of a ray that has just left the surface, to the outside or to the inside:
// it began on the other side, or goes away from the solid, or is still on its way through the inside. (Where
// a <= 0, along a cone, nothing is sure.)
bool hits_again(const Quadratic& q, double t, bool outside);

}  // namespace kdray::primitives
