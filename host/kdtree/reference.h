// What    What the builder works on: a primitive's reference with the bounds of its part inside the current
//         cell.
// Shape   32 bytes, so that two fit a cache line; lo and ref share the first half, hi has the second.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "kdtree/tree.h"

namespace kdray::kdtree {

// A cell, or the bounds of a part of a primitive. Arrays, not vectors: the axis is a run-time index
// everywhere.
struct Bounds {
  std::array<float, 3> lo, hi;

  // True when no point is in all three intervals; a flat box is not empty.
  bool empty() const { return !(lo[0] <= hi[0] && lo[1] <= hi[1] && lo[2] <= hi[2]); }
};

struct alignas(16) BoundedRef {
  std::array<float, 3> lo;
  Ref ref;
  std::array<float, 3> hi;
  std::uint32_t unused = 0;

  Bounds bounds() const { return {lo, hi}; }
};
static_assert(sizeof(BoundedRef) == 32);

inline Bounds no_bounds() {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  return {{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};
}

inline BoundedRef with_bounds(const BoundedRef& r, const Bounds& b) {
  return {b.lo, r.ref, b.hi};
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

inline Bounds hull_of(std::span<const BoundedRef> refs) {
  Bounds bounds = no_bounds();
  for (const BoundedRef& r : refs) bounds = hull(bounds, r.bounds());
  return bounds;
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

}  // namespace kdray::kdtree
