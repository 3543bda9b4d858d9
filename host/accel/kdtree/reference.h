// What    What the builder works on: a primitive's reference with the bounds of its part inside the current
//         cell.
// Shape   32 bytes, so that two fit a cache line; lo and ref share the first half, hi has the second.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "accel/kdtree/tree.h"
#include "base/box.h"

namespace kdray::kdtree {

using kdray::above, kdray::below, kdray::Bounds, kdray::bounds_from, kdray::box_from, kdray::hull,
    kdray::intersection, kdray::no_bounds;

struct alignas(16) BoundedRef {
  std::array<float, 3> lo;
  Ref ref;
  std::array<float, 3> hi;
  std::uint32_t unused = 0;

  Bounds bounds() const { return {lo, hi}; }
};
static_assert(sizeof(BoundedRef) == 32);

inline BoundedRef with_bounds(const BoundedRef& r, const Bounds& b) {
  return {b.lo, r.ref, b.hi};
}

inline Bounds hull_of(std::span<const BoundedRef> refs) {
  Bounds bounds = no_bounds();
  for (const BoundedRef& r : refs) bounds = hull(bounds, r.bounds());
  return bounds;
}

}  // namespace kdray::kdtree
