// What    Rays and shapes in double: where a line crosses a shape, for queries in double; and what is certain
//         of it with the error known, for `kdray verify`.
// Shape   Everything about the scene's centre, on the primitives as rays see them. Each shape's own part is
//         in <kind>_exact.cpp.
// Errors  Crossings are off by some 2^-50 of the lengths in play, and whether there are two of them or none
//         where the line all but touches the shape is decided by as much. Of a sphere or a torus the number
//         of them ahead of the origin is odd where that is inside.
#pragma once

#include <array>
#include <cstddef>

#include "base/vec.h"

namespace kdray::primitives {

struct Line {
  dvec3 origin, direction;
};

// Along a line a solid's surface is where a*t^2 + 2*b*t + c = 0; inside it is negative. A cone's is that of
// the whole double cone.
struct Quadratic {
  double a, b, c;
};

// Where a line crosses a shape: t in ascending order, and u as hits have it.
struct Crossings {
  struct At {
    double t, u;
  };
  std::array<At, 4> at{};
  std::size_t n = 0;

  void add(double t, double u = 0) { at[n++] = {t, u}; }
  const At* begin() const { return at.data(); }
  const At* end() const { return at.data() + n; }
};

// Whether a hit at t is surely none of a ray that has just left the surface, to the outside or to the inside:
// it began on the other side, or goes away from the solid, or is still on its way through the inside. (Where
// a <= 0, along a cone, nothing is sure.)
bool hits_again(const Quadratic& q, double t, bool outside);

}  // namespace kdray::primitives
