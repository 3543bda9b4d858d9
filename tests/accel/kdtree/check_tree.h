// What    What every tree must be: well formed, with disjoint cells, contents inside their cells, and
//         complete.
// Shape   Complete means what traversal needs: for every point of a primitive's surface, at least one leaf
//         whose closed cell and contents hold the point refers to the primitive. (A ray visits all cells that
//         hold a point of it, widened by more than the rounding of the walk, so it visits that leaf.)
#pragma once

#include "accel/kdtree/shapes.h"
#include "accel/kdtree/tree.h"

namespace kdray::test {

// Adds GoogleTest failures; samples `per_primitive` points of each.
void check_shape(const kdtree::Tree& tree, const scene::Geometry& geometry, int max_depth);
void check_complete(const kdtree::Tree& tree, const scene::Geometry& geometry, int per_primitive,
                    std::uint64_t seed);

}  // namespace kdray::test
