// What    The exact builder: every cell is split at the least of all planes' costs; large cells by all
//         threads together, subtrees in one thread each.
// Shape   Where a subtree begins depends on the number of references only, so threads never show in the tree.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "accel/kdtree/build.h"
#include "accel/kdtree/fragment.h"
#include "accel/kdtree/reference.h"

namespace kdray::kdtree {

// What is handed down with a cell.
struct CellState {
  Bounds cell;
  int depth = 0;
  double budget = 0;  // references that the leaves below it may have in all; at least those of the cell
};

// Returns the state with the cell that costs are computed over: the contents' bounds, with
// BuildConfig::tight_cells.
CellState tightened(const CellState& state, std::span<const BoundedRef> refs, const BuildConfig& config);

// `refs` are all primitives' references, `bounds` their hull.
std::unique_ptr<TopNode> build_exact(const scene::Geometry& geometry, const BuildConfig& config,
                                     int max_depth, std::vector<BoundedRef>&& refs, const Bounds& bounds);

}  // namespace kdray::kdtree
