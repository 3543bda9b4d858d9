#include "kdtree/subtree.h"

#include <algorithm>

namespace kdray::kdtree {

namespace {

constexpr double kMaxDuplication = 32;
constexpr double kFreeReferences = 1u << 20;  // a small scene may cut its needles finely at little cost
constexpr double kMostReferences = 1u << 29;  // indices of nodes and references have 30 bits

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
  void build(std::size_t first, const CellState& loose) {
    const std::span<BoundedRef> refs = std::span(stack_).subspan(first);
    const CellState state = tightened(loose, refs, config_);
    const Split split = choose_split(refs, state, config_, max_depth_, scratch_);
    if (!split.found()) return append_leaf(refs, state.depth, out_);
    below_.clear();
    // A leaf needs the references as they were when the budget turns out too small for both sides.
    const bool tight = !fits_budget(state, refs.size(), refs.size());
    if (tight) saved_.assign(refs.begin(), refs.end());
    const std::size_t n_above = partition(geometry_, config_, state.cell, split, refs, below_);
    const std::size_t n_below = below_.size();
    if (tight && !fits_budget(state, n_below, n_above)) return append_leaf(saved_, state.depth, out_);
    stack_.resize(first + n_above);
    stack_.insert(stack_.end(), below_.begin(), below_.end());

    const std::size_t node = out_.nodes.size();
    out_.nodes.emplace_back();
    out_.contents.emplace_back();
    build(first + n_above, child_below(state, split, n_below, n_above));
    stack_.resize(first + n_above);
    out_.nodes[node] = {static_cast<std::uint32_t>(split.axis), split.position,
                        static_cast<std::uint32_t>(node + 1), static_cast<std::uint32_t>(out_.nodes.size())};
    build(first, child_above(state, split, n_below, n_above));
  }

  const scene::Geometry& geometry_;
  const BuildConfig& config_;
  const int max_depth_;
  std::vector<BoundedRef> stack_, below_, saved_;
  SweepScratch scratch_;
  Fragment out_;
};

CellState child_of(const CellState& parent, const Bounds& cell, std::size_t n, std::size_t n_other) {
  const double share =
      n == 0 ? 0 : parent.budget * (static_cast<double>(n) / static_cast<double>(n + n_other));
  return {cell, parent.depth + 1, share};
}

}  // namespace

CellState tightened(const CellState& state, std::span<const BoundedRef> refs, const BuildConfig& config) {
  if (!config.tight_cells || refs.empty()) return state;
  CellState tight = state;
  tight.cell = no_bounds();
  for (const BoundedRef& r : refs) tight.cell = hull(tight.cell, r.bounds());
  return tight;
}

double reference_budget(std::size_t n_primitives) {
  return std::min(kMostReferences, kMaxDuplication * static_cast<double>(n_primitives) + kFreeReferences);
}

bool fits_budget(const CellState& parent, std::size_t n_below, std::size_t n_above) {
  return static_cast<double>(n_below + n_above) <= parent.budget;
}

CellState child_below(const CellState& parent, const Split& split, std::size_t n_below, std::size_t n_above) {
  return child_of(parent, below(parent.cell, split.axis, split.position), n_below, n_above);
}

CellState child_above(const CellState& parent, const Split& split, std::size_t n_below, std::size_t n_above) {
  return child_of(parent, above(parent.cell, split.axis, split.position), n_above, n_below);
}

Split choose_split(std::span<const BoundedRef> refs, const CellState& state, const BuildConfig& config,
                   int max_depth, SweepScratch& scratch) {
  if (state.depth >= max_depth) return {};
  const Split split = find_split(refs, state.cell, config, scratch);
  const double leaf_cost = config.cost_intersect * LeafCost(config)(static_cast<std::uint32_t>(refs.size()));
  return split.found() && split.cost < leaf_cost ? split : Split{};
}

void append_leaf(std::span<const BoundedRef> refs, int depth, Fragment& out) {
  const auto first = static_cast<std::uint32_t>(out.refs.size());
  Bounds contents = no_bounds();
  for (const BoundedRef& r : refs) {
    out.refs.push_back(r.ref);
    contents = hull(contents, r.bounds());
  }
  out.contents.push_back(box_from(contents));
  std::sort(out.refs.begin() + first, out.refs.end());
  out.nodes.push_back({Node::kLeaf, 0, first, static_cast<std::uint32_t>(refs.size())});
  out.max_depth = std::max(out.max_depth, depth);
}

Fragment build_subtree(const scene::Geometry& geometry, const BuildConfig& config, int max_depth,
                       std::vector<BoundedRef>&& refs, const CellState& state) {
  return SubtreeBuilder(geometry, config, max_depth, std::move(refs)).run(state);
}

}  // namespace kdray::kdtree
