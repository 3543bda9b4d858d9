#include "accel/kdtree/exact/top.h"

#include <tbb/parallel_invoke.h>

#include "accel/kdtree/exact/subtree.h"

namespace kdray::kdtree {

namespace {

constexpr std::size_t kSubtree = 4096;  // references; smaller cells are built in one thread

class TopBuilder {
 public:
  TopBuilder(const scene::Geometry& geometry, const BuildConfig& config, int max_depth)
      : geometry_(geometry), config_(config), max_depth_(max_depth) {}

  std::unique_ptr<TopNode> build(std::vector<BoundedRef>&& refs, const CellState& state) const {
    auto node = std::make_unique<TopNode>();
    if (refs.size() <= kSubtree) {
      node->fragment = build_subtree(geometry_, config_, max_depth_, std::move(refs), state);
    } else if (!divide(*node, std::move(refs), state)) {
      append_cell(refs, hull_of(refs), state.depth, config_, node->fragment);
    }
    return node;
  }

 private:
  // False, with refs as they were, where a leaf is to be made.
  bool divide(TopNode& node, std::vector<BoundedRef>&& refs, const CellState& loose) const {
    const CellState state = tightened(loose, refs, config_);
    SweepScratch scratch;
    const Split split = choose_split(refs, state, config_, max_depth_, scratch);
    scratch = {};
    if (!split.found()) return false;
    std::vector<BoundedRef> saved;
    const bool tight = !fits_budget(state.budget, refs.size(), refs.size());
    if (tight) saved = refs;
    Sides sides = partition_large(geometry_, config_, state.cell, split, std::move(refs));
    const std::size_t n_below = sides.below.size(), n_above = sides.above.size();
    if (tight && !fits_budget(state.budget, n_below, n_above)) {
      refs = std::move(saved);
      return false;
    }
    saved = {};
    node.axis = split.axis;
    node.position = split.position;
    tbb::parallel_invoke(
        [&] { node.below = build(std::move(sides.below), child_below(state, split, n_below, n_above)); },
        [&] { node.above = build(std::move(sides.above), child_above(state, split, n_below, n_above)); });
    return true;
  }

  const scene::Geometry& geometry_;
  const BuildConfig& config_;
  const int max_depth_;
};

}  // namespace

std::unique_ptr<TopNode> build_exact(const scene::Geometry& geometry, const BuildConfig& config,
                                     int max_depth, std::vector<BoundedRef>&& refs, const Bounds& bounds) {
  const CellState root{bounds, 0, reference_budget(geometry.size(), config.quality)};
  return TopBuilder(geometry, config, max_depth).build(std::move(refs), root);
}

}  // namespace kdray::kdtree
