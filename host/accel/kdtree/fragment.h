// What    Subtrees: the fragments that threads build, how many references each may have, and how fragments
//         are put in their places in one tree.
// Shape   A fragment's nodes are in depth-first preorder; its indices are relative to the fragment. A split
//         hands its budget of references to its children in proportion to their references. The share depends
//         on the path alone, so threads do not show; it is never below the references that the child has when
//         it is split.
// Why     Splits that only multiply references (needles across many cells, fans around a vertex) still lower
//         the expected cost, without end: the budget ends them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "accel/kdtree/build.h"
#include "accel/kdtree/reference.h"
#include "accel/kdtree/tree.h"

namespace kdray::kdtree {

// A finished subtree, before it is put in its place in the tree.
struct Fragment {
  std::vector<Node> nodes;
  std::vector<Ref> refs;
  std::vector<Box> contents;  // of each node
  int max_depth = 0;

  void clear();
};

// Appends a leaf of n references. Returns where the caller is to write them, in ascending order.
std::span<Ref> add_leaf(std::size_t n, const Bounds& contents, int depth, Fragment& out);

// Writes the references' numbers in ascending order.
void write_sorted(std::span<const BoundedRef> refs, std::span<Ref> out);

// Appends the references of a cell, as a leaf or, where the config says so, as groups (binned/group-inl.h),
// and leaves them in another order. Returns `contents`, their hull.
Box append_cell(std::span<BoundedRef> refs, const Bounds& contents, int depth, const BuildConfig& config,
                Fragment& out);

// Returns how many references the whole tree may have: on average enough for any mesh of plain triangles (2.5
// for slivers, in leaves of 8), and not so many that a mesh of needles takes more than twice their time. The
// exact builder is for those who would rather wait than trace slowly.
inline double reference_budget(std::size_t n_primitives, Quality quality) {
  constexpr double kFree = 1u << 17;  // a small scene may cut its needles finely at little cost
  constexpr double kMost = 1u << 29;  // indices of nodes and references have 30 bits
  const double each = quality == Quality::best ? 32 : 3.5;
  return std::min(kMost, each * static_cast<double>(n_primitives) + kFree);
}

inline bool fits_budget(double budget, std::size_t n_below, std::size_t n_above) {
  return static_cast<double>(n_below + n_above) <= budget;
}

struct Shares {
  double below = 0, above = 0;
};

inline Shares share(double budget, std::size_t n_below, std::size_t n_above) {
  const auto all = static_cast<double>(n_below + n_above);
  if (all == 0) return {};
  return {budget * (static_cast<double>(n_below) / all), budget * (static_cast<double>(n_above) / all)};
}

// The top of the tree: an inner node with two children, or a fragment.
struct TopNode {
  int axis = -1;  // -1: a fragment
  float position = 0;
  std::unique_ptr<TopNode> below, above;
  Fragment fragment;

  bool is_fragment() const { return axis < 0; }
};

// Puts the fragments together: nodes in preorder, left = self + 1. Uses the fragments up; leaves `bounds` to
// the caller.
Tree assemble(TopNode& top);

}  // namespace kdray::kdtree
