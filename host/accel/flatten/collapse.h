// What    Binary nodes collapsed into nodes of up to eight children: which nodes become children of which, in
//         what order for each octant of directions, and where leaves' blocks go. Bounds and blocks are
//         written elsewhere, when all places are known (wide.cpp).
// Shape   openings.h says which nodes become children; empty leaves are dropped. A leaf of several kinds of
//         primitives becomes a child for each.
// Source  Dammertz, Hanika, Keller, EGSR 2008; Wald, Benthin, Boulos, RT 2008.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "accel/flatten/openings.h"
#include "accel/kdtree/tree.h"
#include "layout/wide.layout.h"

namespace kdray::flatten {

// A subtree of the binary tree, whose nodes are [node, end).
struct Subtree {
  std::uint32_t node = 0, end = 0;
  std::uint32_t size() const { return end - node; }
};

// Entries that a walk stacks below a node, for rays of each octant.
using StackNeeds = std::array<std::uint16_t, 8>;

struct CollapsedNode {
  std::uint32_t n = 0;                       // children
  std::array<std::uint32_t, kWidth> item{};  // the binary node that each is
  std::array<layout::u32, kWidth> child{};   // as in layout::WideNode, with places relative to the part
  std::array<layout::u32, kWidth> order{};   // as in layout::WideNode
};

// The collapsed form of a subtree.
struct CollapsedPart {
  // A child that is the root of another part: its number in `cuts`.
  static constexpr layout::u32 kCut = 1u << 30;

  std::vector<CollapsedNode> nodes;  // [0] is the root; children behind their parents
  std::vector<Subtree> cuts;         // where other parts begin
  std::array<std::size_t, primitives::kKinds> n_blocks{};
};

// `cut_at`: subtrees of at most so many nodes, other than the root, are left to other parts; 0: none is.
CollapsedPart collapse(const kdtree::Tree& tree, const Openings& openings, const Subtree& root,
                       std::uint32_t block, std::uint32_t only_kind, std::uint32_t cut_at);

// Returns the needs of a walk that pushes all children of a node, then pops the nearest; `cuts` are those of
// the parts cut off.
StackNeeds stack_needs(const CollapsedPart& part, const std::vector<StackNeeds>& cuts);

// Does the same for one node: `order` as in layout::WideNode, `below` what each of its n children needs.
template <class Order>
StackNeeds needs_of_node(const Order& order, std::uint32_t n,
                         const std::array<const StackNeeds*, kWidth>& below) {
  StackNeeds needs;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    needs[octant] = static_cast<std::uint16_t>(n);
    // Each is popped with those behind it left.
    layout::u32 far_to_near = order[octant] >> (3 * (kWidth - n));
    for (std::uint32_t behind = 0; behind < n; ++behind, far_to_near >>= 3) {
      const auto need = static_cast<std::uint16_t>(behind + (*below[far_to_near & 7u])[octant]);
      needs[octant] = std::max(needs[octant], need);
    }
  }
  return needs;
}

// Returns a leaf's references of one kind. Within a leaf references ascend, so kinds follow each other.
kdtree::RefRun leaf_run(const kdtree::Tree& tree, std::uint32_t leaf, std::uint32_t kind);

// Rewrites the order words of a node of n children whose bounds are set, where these are no longer cells of a
// plane: in a refitted form. Of two boxes, the one in front along the axis that separates them most, or along
// which they overlap least, goes first. Children move forward, from the order that there was,
// past those that they go before: what is still right stays, and where no ray meets both of two boxes, either
// order will do. An order changes no hit, but a mesh that is turned round would be walked from back to front
// by the orders that it was built with, which takes rays twice as long.
void order_anew(layout::WideNode& node, std::uint32_t n);

}  // namespace kdray::flatten
