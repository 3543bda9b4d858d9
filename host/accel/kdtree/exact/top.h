// What    The exact builder: every cell is split at the least of all planes' costs; large cells by all
//         threads together.
// Shape   Where a subtree begins depends on the number of references only, so threads never show in the tree.
#pragma once

#include <memory>
#include <vector>

#include "accel/kdtree/assemble.h"
#include "accel/kdtree/build.h"

namespace kdray::kdtree {

// `refs` are all primitives' references, `bounds` their hull.
std::unique_ptr<TopNode> build_exact(const scene::Geometry& geometry, const BuildConfig& config,
                                     int max_depth, std::vector<BoundedRef>&& refs, const Bounds& bounds);

}  // namespace kdray::kdtree
