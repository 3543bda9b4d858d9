// What    The parallel build: large cells are split by all threads together, subtrees go to one thread each,
//         and the fragments are put together in preorder.
// Shape   Where a subtree begins depends on the number of references only, so threads never show in the tree.
// Errors  ErrorCode::usage for costs that make no sense, ::input for more primitives than a tree can name.

#include "kdtree/build.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "kdray/error.h"
#include "kdtree/subtree.h"

namespace kdray::kdtree {

namespace {

constexpr std::size_t kSubtree = 4096;                   // references; smaller cells are built in one thread
constexpr std::size_t kFineMesh = std::size_t{1} << 19;  // primitives
constexpr int kDepthLimit = 64;                          // the traversal's stack

void check(const BuildConfig& c, std::size_t n) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  if (!positive(c.cost_intersect) || !(std::isfinite(c.cost_traverse) && c.cost_traverse >= 0) ||
      !(positive(c.empty_bonus) && c.empty_bonus <= 1))
    throw Error(ErrorCode::usage, "kd-tree: costs must be positive and the empty-space factor in (0, 1]");
  if (c.block < 1 || c.block > 64 || (c.block & (c.block - 1)) != 0)
    throw Error(ErrorCode::usage, "kd-tree: the block size must be a power of two from 1 to 64");
  if (n > (std::size_t{1} << (kRefIndexBits - 1)))
    throw Error(ErrorCode::input, "too many primitives for one tree: " + std::to_string(n));
}

int depth_for(const BuildConfig& config, std::size_t n) {
  const double automatic = 8 + 1.3 * std::log2(static_cast<double>(std::max<std::size_t>(n, 1)));
  return std::min(kDepthLimit, config.max_depth >= 0 ? config.max_depth : static_cast<int>(automatic));
}

template <class Primitives>
void add_refs(const Primitives& primitives, scene::PrimitiveKind kind, std::vector<BoundedRef>& refs) {
  const std::size_t first = refs.size();
  refs.resize(first + primitives.size());
  tbb::parallel_for(std::size_t{0}, primitives.size(), [&](std::size_t i) {
    const Bounds b = bounds_from(scene::bounds_of(primitives[i]));
    refs[first + i] = {b.lo, make_ref(kind, static_cast<std::uint32_t>(i)), b.hi};
  });
}

std::vector<BoundedRef> all_refs(const scene::Geometry& geometry) {
  std::vector<BoundedRef> refs;
  refs.reserve(geometry.size());
  add_refs(geometry.triangles, scene::PrimitiveKind::triangle, refs);
  add_refs(geometry.spheres, scene::PrimitiveKind::sphere, refs);
  add_refs(geometry.cones, scene::PrimitiveKind::cone, refs);
  return refs;
}

Box bounds_of_refs(const std::vector<BoundedRef>& refs) {
  Box box;
  for (const BoundedRef& r : refs) box.grow(box_from(r.bounds()));
  return box;
}

// The top of the tree: inner nodes with two children, or a fragment.
struct TopNode {
  Split split;
  std::unique_ptr<TopNode> below, above;
  Fragment fragment;
  std::size_t n_nodes = 0, n_refs = 0;
  int max_depth = 0;
};

class TopBuilder {
 public:
  TopBuilder(const scene::Geometry& geometry, const BuildConfig& config, int max_depth)
      : geometry_(geometry), config_(config), max_depth_(max_depth) {}

  std::unique_ptr<TopNode> build(std::vector<BoundedRef>&& refs, const CellState& state) const {
    auto node = std::make_unique<TopNode>();
    if (refs.size() <= kSubtree) {
      node->fragment = build_subtree(geometry_, config_, max_depth_, std::move(refs), state);
    } else if (!divide(*node, std::move(refs), state)) {
      append_leaf(refs, state.depth, node->fragment);
    }
    sum_up(*node);
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
    const bool tight = !fits_budget(state, refs.size(), refs.size());
    if (tight) saved = refs;
    Sides sides = partition_large(geometry_, config_, state.cell, split, std::move(refs));
    const std::size_t n_below = sides.below.size(), n_above = sides.above.size();
    if (tight && !fits_budget(state, n_below, n_above)) {
      refs = std::move(saved);
      return false;
    }
    saved = {};
    node.split = split;
    tbb::parallel_invoke(
        [&] { node.below = build(std::move(sides.below), child_below(state, split, n_below, n_above)); },
        [&] { node.above = build(std::move(sides.above), child_above(state, split, n_below, n_above)); });
    return true;
  }

  static void sum_up(TopNode& node) {
    node.n_nodes = node.fragment.nodes.size();
    node.n_refs = node.fragment.refs.size();
    node.max_depth = node.fragment.max_depth;
    if (!node.split.found()) return;
    node.n_nodes = 1 + node.below->n_nodes + node.above->n_nodes;
    node.n_refs = node.below->n_refs + node.above->n_refs;
    node.max_depth = std::max(node.below->max_depth, node.above->max_depth);
  }

  const scene::Geometry& geometry_;
  const BuildConfig& config_;
  const int max_depth_;
};

// Copies a fragment to its place and makes its indices the tree's.
void place_fragment(Fragment& fragment, std::size_t first_node, std::size_t first_ref, Tree& tree) {
  for (std::size_t i = 0; i < fragment.nodes.size(); ++i) {
    Node node = fragment.nodes[i];
    if (node.is_leaf()) {
      node.left += static_cast<std::uint32_t>(first_ref);
    } else {
      node.left += static_cast<std::uint32_t>(first_node);
      node.right += static_cast<std::uint32_t>(first_node);
    }
    tree.nodes[first_node + i] = node;
  }
  std::copy(fragment.refs.begin(), fragment.refs.end(), tree.refs.begin() + first_ref);
  std::copy(fragment.contents.begin(), fragment.contents.end(), tree.contents.begin() + first_node);
  fragment = {};
}

void place(TopNode& node, std::size_t first_node, std::size_t first_ref, Tree& tree) {
  if (!node.split.found()) return place_fragment(node.fragment, first_node, first_ref, tree);
  const std::size_t below = first_node + 1, above = below + node.below->n_nodes;
  const std::size_t above_ref = first_ref + node.below->n_refs;
  tree.nodes[first_node] = {static_cast<std::uint32_t>(node.split.axis), node.split.position,
                            static_cast<std::uint32_t>(below), static_cast<std::uint32_t>(above)};
  tbb::parallel_invoke([&] { place(*node.below, below, first_ref, tree); },
                       [&] { place(*node.above, above, above_ref, tree); });
}

// Children follow their parents, so one pass from the end sees every child first.
void sum_up_contents(Tree& tree) {
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const Node& node = tree.nodes[i];
    if (node.is_leaf()) continue;
    tree.contents[i] = tree.contents[node.left];
    tree.contents[i].grow(tree.contents[node.right]);
  }
}

}  // namespace

BuildConfig suited(BuildConfig config, std::size_t n_primitives) {
  config.block = n_primitives > kFineMesh ? 8 : 2;
  return config;
}

Tree build(const scene::Geometry& geometry, const BuildConfig& config) {
  const std::size_t n = geometry.size();
  check(config, n);
  Tree tree;
  if (n == 0) {
    tree.nodes.push_back({});
    tree.contents.emplace_back();
    return tree;
  }
  std::vector<BoundedRef> refs = all_refs(geometry);
  tree.bounds = bounds_of_refs(refs);
  const CellState root{bounds_from(tree.bounds), 0, reference_budget(n)};
  const std::unique_ptr<TopNode> top =
      TopBuilder(geometry, config, depth_for(config, n)).build(std::move(refs), root);
  tree.nodes.resize(top->n_nodes);
  tree.contents.resize(top->n_nodes);
  tree.refs.resize(top->n_refs);
  tree.max_depth = top->max_depth;
  place(*top, 0, 0, tree);
  sum_up_contents(tree);
  return tree;
}

}  // namespace kdray::kdtree
