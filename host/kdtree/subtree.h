// What    Builds a subtree in one thread, and says what all builders agree on: when a cell becomes a leaf and
//         how many references a subtree may have.
#pragma once

#include <vector>

#include "kdtree/build.h"
#include "kdtree/partition.h"
#include "kdtree/split.h"

namespace kdray::kdtree {

// Nodes in depth-first preorder with indices relative to the fragment.
struct Fragment {
  std::vector<Node> nodes;
  std::vector<Ref> refs;
  std::vector<Box> contents;  // of each node; of inner nodes empty as yet
  int max_depth = 0;
};

// What is handed down with a cell.
struct CellState {
  Bounds cell;
  int depth = 0;
  double budget = 0;  // references that the leaves below it may have in all; at least those of the cell
};

// The state with the cell that costs are reckoned over: the contents' bounds, with BuildConfig::tight_cells.
CellState tightened(const CellState& state, std::span<const BoundedRef> refs, const BuildConfig& config);

// The whole tree's budget. Splits that only multiply references (needles across many cells, fans around a
// vertex) still lower the expected cost, without end: the budget ends them.
double reference_budget(std::size_t n_primitives);

// The children's states. Each gets its share of the budget in proportion to its references.
bool fits_budget(const CellState& parent, std::size_t n_below, std::size_t n_above);
CellState child_below(const CellState& parent, const Split& split, std::size_t n_below, std::size_t n_above);
CellState child_above(const CellState& parent, const Split& split, std::size_t n_below, std::size_t n_above);

// The split to make, or none where a leaf is cheaper or the depth is used up.
Split choose_split(std::span<const BoundedRef> refs, const CellState& state, const BuildConfig& config,
                   int max_depth, SweepScratch& scratch);

void append_leaf(std::span<const BoundedRef> refs, int depth, Fragment& out);

Fragment build_subtree(const scene::Geometry& geometry, const BuildConfig& config, int max_depth,
                       std::vector<BoundedRef>&& refs, const CellState& state);

}  // namespace kdray::kdtree
