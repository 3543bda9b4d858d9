// What    Puts the fragments that threads have built in their places in one tree.
#pragma once

#include <memory>

#include "accel/kdtree/fragment.h"

namespace kdray::kdtree {

// The top of the tree: an inner node with two children, or a fragment.
struct TopNode {
  int axis = -1;  // -1: a fragment
  float position = 0;
  std::unique_ptr<TopNode> below, above;
  Fragment fragment;

  bool is_fragment() const { return axis < 0; }
};

// Nodes in preorder, left = self + 1; `bounds` is left for the caller. Uses the fragments up.
Tree assemble(TopNode& top);

}  // namespace kdray::kdtree
