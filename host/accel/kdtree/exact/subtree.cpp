#include "accel/kdtree/exact/subtree.h"

#include "accel/kdtree/exact/median_split.h"

namespace kdray::kdtree {

namespace {

// References live on one stack. A cell's are its top: those above the plane stay, those below it go on top
// and are built first, so that nodes come out in preorder. Recursion is as deep as the tree: 64 levels at
// most.
class SubtreeBuilder {
 public:
  SubtreeBuilder(const scene::Geometry& geometry, const BuildConfig& config, int max_depth,
                 std::vector<BoundedRef>&& refs)
      : geometry_(geometry), config_(config), max_depth_(max_depth), stack_(std::move(refs)) {}

  Fragment run(const CellState& state) {
    out_.nodes.reserve(stack_.size() * 2);
    out_.refs.reserve(stack_.size() * 2);
    build(0, state);
    return std::move(out_);
  }

 private:
  // Returns the hull of what the leaves hold.
  Box build(std::size_t first, const CellState& loose) {
    const std::span<BoundedRef> refs = std::span(stack_).subspan(first);
    const CellState state = tightened(loose, refs, config_);
    const Split split = choose_split(refs, state, config_, max_depth_, scratch_);
    if (!split.found()) return append_cell(refs, hull_of(refs), state.depth, config_, out_);
    below_.clear();
    // A leaf needs the references as they were when the budget turns out too small for both sides.
    const bool tight = !fits_budget(state.budget, refs.size(), refs.size());
    if (tight) saved_.assign(refs.begin(), refs.end());
    const std::size_t n_above = partition(geometry_, config_, state.cell, split, refs, below_);
    const std::size_t n_below = below_.size();
    if (tight && !fits_budget(state.budget, n_below, n_above))
      return append_cell(saved_, hull_of(saved_), state.depth, config_, out_);
    stack_.resize(first + n_above);
    stack_.insert(stack_.end(), below_.begin(), below_.end());

    const std::size_t node = out_.nodes.size();
    out_.nodes.emplace_back();
    out_.contents.emplace_back();
    Box contents = build(first + n_above, child_below(state, split, n_below, n_above));
    stack_.resize(first + n_above);
    out_.nodes[node] = {static_cast<std::uint32_t>(split.axis), split.position,
                        static_cast<std::uint32_t>(node + 1), static_cast<std::uint32_t>(out_.nodes.size())};
    contents.grow(build(first, child_above(state, split, n_below, n_above)));
    out_.contents[node] = contents;
    return contents;
  }

  const scene::Geometry& geometry_;
  const BuildConfig& config_;
  const int max_depth_;
  std::vector<BoundedRef> stack_, below_, saved_;
  SweepScratch scratch_;
  Fragment out_;
};

}  // namespace

CellState tightened(const CellState& state, std::span<const BoundedRef> refs, const BuildConfig& config) {
  if (!config.tight_cells || refs.empty()) return state;
  CellState tight = state;
  tight.cell = hull_of(refs);
  return tight;
}

CellState child_below(const CellState& parent, const Split& split, std::size_t n_below, std::size_t n_above) {
  return {below(parent.cell, split.axis, split.position), parent.depth + 1,
          share(parent.budget, n_below, n_above).below};
}

CellState child_above(const CellState& parent, const Split& split, std::size_t n_below, std::size_t n_above) {
  return {above(parent.cell, split.axis, split.position), parent.depth + 1,
          share(parent.budget, n_below, n_above).above};
}

Split choose_split(std::span<const BoundedRef> refs, const CellState& state, const BuildConfig& config,
                   int max_depth, SweepScratch& scratch) {
  if (state.depth >= max_depth) return {};
  if (config.split_rule != SplitRule::sah) return median_split(refs, state.cell, config.split_rule);
  const Split split = find_split(refs, state.cell, config, scratch);
  const double leaf_cost = config.cost_intersect * LeafCost(config)(static_cast<std::uint32_t>(refs.size()));
  return split.found() && split.cost < leaf_cost ? split : Split{};
}

Fragment build_subtree(const scene::Geometry& geometry, const BuildConfig& config, int max_depth,
                       std::vector<BoundedRef>&& refs, const CellState& state) {
  return SubtreeBuilder(geometry, config, max_depth, std::move(refs)).run(state);
}

}  // namespace kdray::kdtree
