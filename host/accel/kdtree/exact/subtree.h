// What    Builds a subtree of exact splits in one thread.
#pragma once

#include <vector>

#include "accel/kdtree/budget.h"
#include "accel/kdtree/build.h"
#include "accel/kdtree/exact/partition.h"
#include "accel/kdtree/exact/split.h"
#include "accel/kdtree/fragment.h"

namespace kdray::kdtree {

// What is handed down with a cell.
struct CellState {
  Bounds cell;
  int depth = 0;
  double budget = 0;  // references that the leaves below it may have in all; at least those of the cell
};

// The state with the cell that costs are reckoned over: the contents' bounds, with BuildConfig::tight_cells.
CellState tightened(const CellState& state, std::span<const BoundedRef> refs, const BuildConfig& config);

CellState child_below(const CellState& parent, const Split& split, std::size_t n_below, std::size_t n_above);
CellState child_above(const CellState& parent, const Split& split, std::size_t n_below, std::size_t n_above);

// The split to make, or none where a leaf is cheaper or the depth is used up.
Split choose_split(std::span<const BoundedRef> refs, const CellState& state, const BuildConfig& config,
                   int max_depth, SweepScratch& scratch);

Fragment build_subtree(const scene::Geometry& geometry, const BuildConfig& config, int max_depth,
                       std::vector<BoundedRef>&& refs, const CellState& state);

}  // namespace kdray::kdtree
