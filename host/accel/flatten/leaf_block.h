// What    The wide form read again: the blocks of a leaf of triangles, and a node's children.
#pragma once

#include <cstdint>

#include "accel/flatten/openings.h"
#include "accel/flatten/wide.h"
#include "base/box.h"
#include "layout/instances.layout.h"
#include "layout/tree.layout.h"

namespace kdray::flatten {

inline bool is_leaf(layout::u32 child) {
  return (child & KDRAY_WIDE_LEAF) != 0;
}

inline bool is_instance(layout::u32 child) {
  return (child & ~KDRAY_WIDE_FIRST_MASK) == KDRAY_INSTANCE_LEAF;
}

// Whether a child is a leaf of that kind's primitives.
template <class Kind>
bool is_leaf_of(layout::u32 child) {
  return is_leaf(child) && leaf_kind(child) == Kind::kNumber;
}

inline Box bounds_of_child(const layout::WideNode& node, std::uint32_t slot) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = node.bounds[axis][0][slot];
    box.hi[axis] = node.bounds[axis][1][slot];
  }
  return box;
}
inline void set_bounds(layout::WideNode& node, std::uint32_t slot, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    node.bounds[axis][0][slot] = box.lo[axis];
    node.bounds[axis][1][slot] = box.hi[axis];
  }
}

// A slot without child has no bounds either. (Its child is 0, the root.)
inline bool has_child(const layout::WideNode& node, std::uint32_t slot) {
  return node.child[slot] != 0;
}

// The i-th block of triangles: how many of its lanes hold some, and whether its leaf ends here.
struct LeafBlock {
  const layout::u32* words = nullptr;
  const layout::u32* indices = nullptr;  // the last of its rows
  std::uint32_t n = 0;
  bool is_last = false;

  LeafBlock(const Array<layout::u32>& blocks, std::size_t i, std::uint32_t block)
      : words(blocks.data() + i * KDRAY_TRIANGLE_ROWS * block),
        indices(words + KDRAY_ROW_TRIANGLE_INDEX * block) {
    while (n < block && !is_last) is_last = (indices[n++] & KDRAY_WIDE_LAST) != 0;
  }
  std::uint32_t index(std::uint32_t lane) const { return indices[lane] & KDRAY_REF_INDEX_MASK; }
};

}  // namespace kdray::flatten
