// What    A cell, or the bounds of a part of a primitive: boxes whose axis is a run-time index everywhere.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "base/box.h"

namespace kdray {

struct Bounds {
  std::array<float, 3> lo, hi;

  // True when no point is in all three intervals; a flat box is not empty.
  bool empty() const { return !(lo[0] <= hi[0] && lo[1] <= hi[1] && lo[2] <= hi[2]); }
};

inline Bounds no_bounds() {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  return {{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};
}

inline Bounds intersection(const Bounds& a, const Bounds& b) {
  Bounds c;
  for (int k = 0; k < 3; ++k) {
    c.lo[k] = std::max(a.lo[k], b.lo[k]);
    c.hi[k] = std::min(a.hi[k], b.hi[k]);
  }
  return c;
}

inline Bounds hull(const Bounds& a, const Bounds& b) {
  Bounds c;
  for (int k = 0; k < 3; ++k) {
    c.lo[k] = std::min(a.lo[k], b.lo[k]);
    c.hi[k] = std::max(a.hi[k], b.hi[k]);
  }
  return c;
}

inline Bounds below(Bounds b, int axis, float position) {
  b.hi[axis] = std::min(b.hi[axis], position);
  return b;
}
inline Bounds above(Bounds b, int axis, float position) {
  b.lo[axis] = std::max(b.lo[axis], position);
  return b;
}

inline Bounds bounds_from(const Box& b) {
  return {{b.lo.x, b.lo.y, b.lo.z}, {b.hi.x, b.hi.y, b.hi.z}};
}
inline Box box_from(const Bounds& b) {
  return {{b.lo[0], b.lo[1], b.lo[2]}, {b.hi[0], b.hi[1], b.hi[2]}};
}

}  // namespace kdray
