#include "accel/kdtree/exact/exact.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <vector>

#include "accel/kdtree/build.h"
#include "accel/kdtree/clip.h"
#include "accel/kdtree/fragment.h"

namespace kdray::kdtree {

namespace {

constexpr std::size_t kChunk = 8192;  // references to a parallel task

enum class Side { below, above, both };

Side side_of(const BoundedRef& r, const Split& split) {
  const float lo = r.lo[split.axis], hi = r.hi[split.axis];
  if (lo == split.position && hi == split.position) return split.planar_below ? Side::below : Side::above;
  if (hi <= split.position) return Side::below;
  return lo >= split.position ? Side::above : Side::both;
}

// Hands a cell's references to the two children of a split; references that straddle the plane are clipped
// into both. Appends to `below_refs`; what is above is kept at the front of `refs`, which has space since a
// reference has at most one part there. Returns the number above. Order is kept on both sides.
std::size_t partition(const scene::Geometry& geometry, const BuildConfig& config, const Bounds& cell,
                      const Split& split, std::span<BoundedRef> refs, std::vector<BoundedRef>& below_refs) {
  std::size_t n_above = 0;
  for (const BoundedRef r : refs) {
    switch (side_of(r, split)) {
      case Side::below:
        below_refs.push_back(r);
        break;
      case Side::above:
        refs[n_above++] = r;
        break;
      case Side::both: {
        const SplitBounds parts = config.clip ? clip_to_sides(geometry, r, cell, split.axis, split.position)
                                              : SplitBounds{below(r.bounds(), split.axis, split.position),
                                                            above(r.bounds(), split.axis, split.position)};
        if (!parts.below.empty()) below_refs.push_back(with_bounds(r, parts.below));
        if (!parts.above.empty()) refs[n_above++] = with_bounds(r, parts.above);
        break;
      }
    }
  }
  return n_above;
}

struct Sides {
  std::vector<BoundedRef> below, above;
};

// Does the same for large cells, in parallel, into new vectors. Uses `refs` up.
Sides partition_large(const scene::Geometry& geometry, const BuildConfig& config, const Bounds& cell,
                      const Split& split, std::vector<BoundedRef>&& refs) {
  const std::size_t n_chunks = (refs.size() + kChunk - 1) / kChunk;
  std::vector<std::vector<BoundedRef>> below_parts(n_chunks);
  std::vector<std::size_t> n_above(n_chunks), first_below(n_chunks + 1, 0), first_above(n_chunks + 1, 0);
  tbb::parallel_for(std::size_t{0}, n_chunks, [&](std::size_t c) {
    const std::span<BoundedRef> part =
        std::span(refs).subspan(c * kChunk, std::min(kChunk, refs.size() - c * kChunk));
    n_above[c] = partition(geometry, config, cell, split, part, below_parts[c]);
  });
  for (std::size_t c = 0; c < n_chunks; ++c) {
    first_below[c + 1] = first_below[c] + below_parts[c].size();
    first_above[c + 1] = first_above[c] + n_above[c];
  }
  Sides sides;
  sides.below.resize(first_below[n_chunks]);
  sides.above.resize(first_above[n_chunks]);
  tbb::parallel_for(std::size_t{0}, n_chunks, [&](std::size_t c) {
    std::copy(below_parts[c].begin(), below_parts[c].end(), sides.below.begin() + first_below[c]);
    std::copy_n(refs.begin() + c * kChunk, n_above[c], sides.above.begin() + first_above[c]);
  });
  refs = {};
  return sides;
}

CellState child_below(const CellState& parent, const Split& split, std::size_t n_below, std::size_t n_above) {
  return {below(parent.cell, split.axis, split.position), parent.depth + 1,
          share(parent.budget, n_below, n_above).below};
}

CellState child_above(const CellState& parent, const Split& split, std::size_t n_below, std::size_t n_above) {
  return {above(parent.cell, split.axis, split.position), parent.depth + 1,
          share(parent.budget, n_below, n_above).above};
}

// Returns the split to make, or none where a leaf is cheaper or the depth is used up.
Split choose_split(std::span<const BoundedRef> refs, const CellState& state, const BuildConfig& config,
                   int max_depth, SweepScratch& scratch) {
  if (state.depth >= max_depth) return {};
  if (config.split_rule != SplitRule::sah) return median_split(refs, state.cell, config.split_rule);
  const Split split = find_split(refs, state.cell, config, scratch);
  const double leaf_cost = config.cost_intersect * LeafCost(config)(static_cast<std::uint32_t>(refs.size()));
  return split.found() && split.cost < leaf_cost ? split : Split{};
}

// Builds a subtree in one thread. References live on one stack. A cell's are its top: those above the plane
// stay, those below it go on top and are built first, so that nodes come out in preorder. Recursion is as
// deep as the tree: 64 levels at most.
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
    // A leaf needs the references as they were where the budget turns out to be too small for both sides.
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

constexpr std::size_t kSubtree = 4096;  // references; smaller cells are built in one thread

class TopBuilder {
 public:
  TopBuilder(const scene::Geometry& geometry, const BuildConfig& config, int max_depth)
      : geometry_(geometry), config_(config), max_depth_(max_depth) {}

  std::unique_ptr<TopNode> build(std::vector<BoundedRef>&& refs, const CellState& state) const {
    auto node = std::make_unique<TopNode>();
    if (refs.size() <= kSubtree) {
      node->fragment = SubtreeBuilder(geometry_, config_, max_depth_, std::move(refs)).run(state);
    } else if (!divide(*node, std::move(refs), state)) {
      append_cell(refs, hull_of(refs), state.depth, config_, node->fragment);
    }
    return node;
  }

 private:
  // Divides the node in two. Returns false, with refs as they were, where it must become a leaf.
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

CellState tightened(const CellState& state, std::span<const BoundedRef> refs, const BuildConfig& config) {
  if (!config.tight_cells || refs.empty()) return state;
  CellState tight = state;
  tight.cell = hull_of(refs);
  return tight;
}

std::unique_ptr<TopNode> build_exact(const scene::Geometry& geometry, const BuildConfig& config,
                                     int max_depth, std::vector<BoundedRef>&& refs, const Bounds& bounds) {
  const CellState root{bounds, 0, reference_budget(geometry.size(), config.quality)};
  return TopBuilder(geometry, config, max_depth).build(std::move(refs), root);
}

}  // namespace kdray::kdtree
