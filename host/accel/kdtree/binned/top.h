// What    The binned builder: the top of the tree level by level with all threads at work on every level,
//         then subtrees, the largest first, each in one thread.
// Shape   The tree is the same for any number of threads and on any instruction set: what is chosen depends
//         on the references and their order alone, which neither changes.
#pragma once

#include <memory>

#include "accel/kdtree/assemble.h"
#include "accel/kdtree/build.h"

namespace kdray::kdtree::binned {

// `bounds` becomes the hull of all primitives, of which there is at least one.
std::unique_ptr<TopNode> build_binned(const scene::Geometry& geometry, const BuildConfig& config,
                                      int max_depth, Bounds& bounds);

}  // namespace kdray::kdtree::binned
