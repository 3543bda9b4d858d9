// What    The wide form of a kd-tree (kernels/layout/wide.layout.h): collapsed nodes and leaf blocks, ready
//         to upload.
// Shape   openings.h says which nodes become whose children; empty leaves are dropped. A leaf that holds
//         several kinds of primitives becomes a child for each of them. Within a node and a leaf the order is
//         the tree's, so the form is the same on every machine.
// Source  Kd cells are disjoint: one order for each octant of directions is front to back for all rays of it,
//         without a sort; among a cell's groups it nearly is, and no walk relies on it.
// Errors  ErrorCode::input where the form has more nodes or blocks than its indices can name.
#pragma once

#include "accel/flatten/flatten.h"
#include "accel/kdtree/tree.h"
#include "base/memory.h"
#include "layout/kinds.h"
#include "layout/wide.layout.h"

namespace kdray::flatten {

struct WideForm {
  int block = 8;  // primitives to a block
  Array<layout::WideNode> nodes;
// Words, a float's bits or an index.
#define KDRAY_BLOCK_ARRAY(NAME, name, names, Struct) Array<layout::u32> name##_blocks;
  KDRAY_KINDS(KDRAY_BLOCK_ARRAY)
#undef KDRAY_BLOCK_ARRAY
  // The factor by which the usual widening of boxes is multiplied, a power of two: more than 1 where there
  // are instances.
  int widen = 1;
  int stack_size = 0;  // the most entries that a walk stacks which pushes all children of a node, for any ray

  std::size_t bytes() const;
};

// Calls visit(array) for each of them, in the order of the members (see for_each_flat_array).
template <class Wide, class Visit>
void for_each_wide_array(Wide& wide, const Visit& visit) {
  auto& [block, nodes, KDRAY_KINDS(KDRAY_KIND_BLOCKS) widen, stack_size] = wide;
  visit(nodes);
  primitives::for_each_kind([&](auto kind) { visit(decltype(kind)::blocks_of(wide)); });
}

// Returns the kind of the primitives of a leaf (a child with KDRAY_WIDE_LEAF).
inline std::uint32_t leaf_kind(layout::u32 leaf) {
  return leaf >> KDRAY_WIDE_KIND_SHIFT & KDRAY_WIDE_KIND_MASK;
}

// `primitives` has the arrays that the tree's references name; `block` is 4 or 8.
WideForm make_wide(const kdtree::Tree& tree, const FlatScene& primitives, int block);

// How many lanes the leaves' blocks have, by the size of blocks.
struct Lanes {
  std::size_t of4 = 0, of8 = 0;
};
Lanes count_lanes(const kdtree::Tree& tree);

// Returns the block size: 8 where it takes at most half as many lanes again as 4 would, as for fine meshes,
// else 4.
int choose_block(const Lanes& lanes);
int choose_block(const kdtree::Tree& tree);

}  // namespace kdray::flatten
