// What    Which nodes of the binary tree are opened into the children of one wide node, so that a ray is
//         expected to visit the fewest wide nodes.
// Why     Opening the largest first until there are eight leaves the lowest nodes half empty: 4.6 children
//         instead of 5.5.
// Shape   Bottom up, for each subtree and each number of slots that it may fill: it is one child, a wide node
//         of its own, or its two sides share the slots. A ray visits a node with a chance in proportion to
//         the surface of its contents. Sums are floats in a fixed order, ties open and go to the smaller
//         share, so that threads can't change the result.
// Source  Ylitie, Karras, Laine, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs",
//         HPG 2017, section 3.
#pragma once

#include <cstdint>

#include "accel/kdtree/tree.h"
#include "base/memory.h"
#include "scene/primitives/kinds.h"

namespace kdray::flatten {

inline constexpr std::uint32_t kWidth = 8;
static_assert(primitives::kKinds <= kWidth, "a leaf of all kinds has a child for each in one node");

// The one kind of primitives that a tree holds, or:
inline constexpr std::uint32_t kAnyKind = ~0u;

class Openings {
 public:
  Openings(const kdtree::Tree& tree, std::uint32_t only_kind);

  // Returns how many of so many slots, 1 to 8, go to what is below the node's plane; 0: the node is one
  // child. For inner nodes with something on both sides, which eight slots always open.
  std::uint32_t share_below(std::uint32_t node, std::uint32_t n_slots) const {
    return shares_[node] >> (3 * (n_slots - 1)) & 7u;
  }

 private:
  RawVector<std::uint32_t> shares_;  // 3 bits for each number of slots
};

// Counts the kinds of primitives that a leaf refers to: each becomes a child of its own. References of a kind
// follow each other.
std::uint32_t n_kinds(const kdtree::Tree& tree, std::uint32_t leaf);

}  // namespace kdray::flatten
