// What    Builds a subtree in one thread, on a stack of references that fits the cache.
// Shape   A cell's references are the stack's top. Those above the plane stay, those below it go on top and
//         are built first, so that nodes come out in preorder. Recursion is as deep as the tree: 64 levels at
//         most.
#if defined(KDRAY_BINNED_SUBTREE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_SUBTREE_INL_H
#undef KDRAY_BINNED_SUBTREE_INL_H
#else
#define KDRAY_BINNED_SUBTREE_INL_H
#endif

#include "accel/kdtree/binned/bins-inl.h"
#include "accel/kdtree/binned/divide-inl.h"
#include "accel/kdtree/binned/exact-inl.h"
#include "accel/kdtree/binned/group-inl.h"
#include "accel/kdtree/binned/leaf-inl.h"
#include "accel/kdtree/fragment.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

HWY_ATTR inline Plane cheaper_than_leaf(const Best& best, std::size_t n, const BuildConfig& config) {
  const float leaf = static_cast<float>(config.cost_intersect) * TestCost(config.block).of(n);
  return best.plane.found() && best.cost < leaf ? best.plane : Plane{};
}

HWY_ATTR inline Plane choose_plane(std::span<const BoundedRef> refs, const Bounds& contents,
                                   const BuildConfig& config) {
  if (refs.size() <= kSmallCell)
    return cheaper_than_leaf(best_of_all(refs, contents, config), refs.size(), config);
  const BinGrid grid = make_bin_grid(contents);
  BinCounts counts;
  count_bins(refs, grid, sample_stride(refs.size()), counts);
  Best best = best_between_bins(counts, grid, contents, refs.size(), config);
  if (best.plane.found() && refs.size() <= kRefined) refine(refs, contents, grid, config, best);
  return cheaper_than_leaf(best, refs.size(), config);
}

// Returns whether no split of n references can be cheaper than a leaf: both children would be tested, one
// reference at least in each, and their chances add up to 1 at least. (The factor is for rounding.)
HWY_ATTR inline bool is_leaf_anyway(std::size_t n, const BuildConfig& config) {
  const TestCost tests(config.block);
  const auto traverse = static_cast<float>(config.cost_traverse),
             intersect = static_cast<float>(config.cost_intersect);
  return n <= 1 || (traverse + intersect * tests.of(1)) * (1 - 0x1p-18f) > intersect * tests.of(n);
}

class SubtreeBuilder {
 public:
  SubtreeBuilder(const scene::Geometry& geometry, const BuildConfig& config, int max_depth,
                 Workspace& workspace)
      : geometry_(geometry),
        config_(config),
        max_depth_(max_depth),
        stack_(workspace.stack),
        straddlers_(workspace.straddlers),
        sweep_(workspace.sweep),
        out_(workspace.fragment) {}

  // Builds the subtree of the references stack[first, first + n), behind which the stack is free. Returns the
  // hull of what the leaves hold.
  HWY_ATTR Box build(std::size_t first, std::size_t n, const Cell& cell) {
    const std::span<BoundedRef> refs(stack_.data() + first, n);
    if (is_leaf_anyway(n, config_) || cell.depth >= max_depth_) return append_leaf(refs, cell);
    const Plane plane = choose_plane(refs, cell.contents, config_);
    if (!plane.found()) return append_leaf(refs, cell);
    ensure_capacity(first, n);
    BoundedRef *const above = stack_.data() + first, *const below = above + n + 1;
    const Sorted sorted = sort_sides(above, n, plane, below, above, straddlers_.data());
    Divided sides{sorted.n_below, sorted.n_above};
    if (!fits(cell.budget, sides, sorted.n_straddling)) {
      std::copy_n(below, sides.n_below, above + sides.n_above);
      std::copy_n(straddlers_.data(), sorted.n_straddling, above + sides.n_above + sides.n_below);
      return append_leaf({above, n}, cell);
    }
    clip_straddling(geometry_, config_, {straddlers_.data(), sorted.n_straddling}, plane, below, above,
                    sides);
    return build_children(first, n, cell, plane, sides);
  }

 private:
  HWY_ATTR Box append_leaf(std::span<BoundedRef> refs, const Cell& cell) {
    if (!config_.groups) return append_ranked_leaf(refs, cell.contents, cell.depth, out_);
    return Grouper(config_, cell.depth, straddlers_, sweep_, out_).append(refs, cell.contents);
  }

  HWY_ATTR Box build_children(std::size_t first, std::size_t n, const Cell& cell, const Plane& plane,
                              const Divided& sides) {
    const std::size_t node = out_.nodes.size();
    out_.nodes.emplace_back();
    out_.contents.emplace_back();
    const Shares shares = share(cell.budget, sides.n_below, sides.n_above);
    Box contents = build_child(first + n + 1, sides.n_below, cell.depth + 1, shares.below);
    out_.nodes[node] = {static_cast<std::uint32_t>(plane.axis), plane.position,
                        static_cast<std::uint32_t>(node + 1), static_cast<std::uint32_t>(out_.nodes.size())};
    contents.grow(build_child(first, sides.n_above, cell.depth + 1, shares.above));
    out_.contents[node] = contents;
    return contents;
  }

  HWY_ATTR Box build_child(std::size_t first, std::size_t n, int depth, double budget) {
    return build(first, n, {hull_of_refs({stack_.data() + first, n}), depth, budget});
  }

  static bool fits(double budget, const Divided& sides, std::size_t n_straddling) {
    return static_cast<double>(sides.n_below + sides.n_above + 2 * n_straddling) <= budget;
  }

  // The stack needs space behind the cell for all references that may go below the plane, and for one in each
  // place that is written in vain.
  void ensure_capacity(std::size_t first, std::size_t n) {
    if (stack_.size() < first + 2 * n + 2) stack_.resize(2 * (first + 2 * n + 2));
    if (straddlers_.size() < n + 1) straddlers_.resize(2 * n + 1);
  }

  const scene::Geometry& geometry_;
  const BuildConfig& config_;
  const int max_depth_;
  std::vector<BoundedRef>&stack_, &straddlers_;
  SweepBuffers& sweep_;
  Fragment& out_;
};

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
