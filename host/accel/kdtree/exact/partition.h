// What    Hands a cell's references to the two children of a split; references that straddle the plane are
//         clipped into both.
#pragma once

#include <span>
#include <vector>

#include "accel/kdtree/build.h"
#include "accel/kdtree/reference.h"
#include "accel/kdtree/sah.h"

namespace kdray::kdtree {

struct Sides {
  std::vector<BoundedRef> below, above;
};

// Appends to `below`; what is above is kept at the front of `refs`, which has room since a reference has at
// most one part there. Returns the number above. Order is kept on both sides.
std::size_t partition(const scene::Geometry& geometry, const BuildConfig& config, const Bounds& cell,
                      const Split& split, std::span<BoundedRef> refs, std::vector<BoundedRef>& below);

// The same for large cells, in parallel, into new vectors. `refs` is used up.
Sides partition_large(const scene::Geometry& geometry, const BuildConfig& config, const Bounds& cell,
                      const Split& split, std::vector<BoundedRef>&& refs);

}  // namespace kdray::kdtree
