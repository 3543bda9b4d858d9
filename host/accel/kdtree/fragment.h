// What    A finished subtree, before it is put in its place in the tree.
// Shape   Nodes in depth-first preorder; indices are relative to the fragment.
#pragma once

#include <span>
#include <vector>

#include "accel/kdtree/build.h"
#include "accel/kdtree/reference.h"
#include "accel/kdtree/tree.h"

namespace kdray::kdtree {

struct Fragment {
  std::vector<Node> nodes;
  std::vector<Ref> refs;
  std::vector<Box> contents;  // of each node
  int max_depth = 0;

  void clear();
};

// Appends a leaf of n references, which the caller writes, in ascending order, to where the result is.
std::span<Ref> add_leaf(std::size_t n, const Bounds& contents, int depth, Fragment& out);

// The references' numbers in ascending order.
void write_sorted(std::span<const BoundedRef> refs, std::span<Ref> out);

// Appends what is in a cell, as a leaf or, where the config says so, as groups (binned/group-inl.h); leaves
// the references in another order. Returns `contents`, their hull.
Box append_cell(std::span<BoundedRef> refs, const Bounds& contents, int depth, const BuildConfig& config,
                Fragment& out);

}  // namespace kdray::kdtree
