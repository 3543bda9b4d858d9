// What    A kd-tree over primitives of all kinds, as the builder leaves it and flatten/ packs it.
// Shape   nodes[0] is the root; a leaf names a run of `refs`. A reference is the kind in the top four bits
//         and the index into that kind's array of scene::Geometry below them; within a leaf they ascend. What
//         is in a cell may be in *groups*: a subtree whose nodes part primitives, not space. Their contents
//         may overlap, and they refer to each primitive of the cell once. Below groups there are no planes.
#pragma once

#include <cstdint>

#include "base/box.h"
#include "base/memory.h"
#include "layout/tree.layout.h"
#include "scene/model/geometry.h"

namespace kdray::kdtree {

using Ref = std::uint32_t;
inline constexpr std::uint32_t kRefIndexBits = KDRAY_REF_KIND_SHIFT;
inline constexpr Ref make_ref(scene::PrimitiveKind kind, std::uint32_t index) {
  return (static_cast<std::uint32_t>(kind) << kRefIndexBits) | index;
}
inline constexpr std::uint32_t kind_number(Ref r) {
  return r >> kRefIndexBits;
}
inline constexpr scene::PrimitiveKind ref_kind(Ref r) {
  return static_cast<scene::PrimitiveKind>(kind_number(r));
}
inline constexpr std::uint32_t ref_index(Ref r) {
  return r & ((1u << kRefIndexBits) - 1);
}

struct Node {
  static constexpr std::uint32_t kLeaf = 3;
  static constexpr std::uint32_t kGroups = 4;
  std::uint32_t axis =
      kLeaf;        // 0, 1, 2: the split plane's axis; kLeaf; kGroups + the axis along which groups are apart
  float split = 0;  // the plane's coordinate
  std::uint32_t left = 0;   // inner: child below the plane;  leaf: first reference
  std::uint32_t right = 0;  // inner: child above the plane;  leaf: number of references
  bool is_leaf() const { return axis == kLeaf; }
  bool has_groups() const { return axis >= kGroups; }
  std::uint32_t order_axis() const { return axis & 3u; }  // of an inner node: its left side is the lower one
};

// A run of references.
struct RefRun {
  std::uint32_t first = 0, n = 0;
};

struct Tree {
  RawVector<Node> nodes;
  RawVector<Ref> refs;
  RawVector<Box>
      contents;       // of each node: bounds of what its leaves hold, clipped to their cells; empty boxes too
  Box bounds;         // of the geometry; the root's cell
  int max_depth = 0;  // of any leaf; a lone root leaf has depth 0
};

// Returns the last node of a subtree.
inline std::uint32_t last_leaf(const Tree& tree, std::uint32_t node) {
  while (!tree.nodes[node].is_leaf()) node = tree.nodes[node].right;
  return node;
}

// Returns what a leaf, or all groups of a cell, refer to.
inline RefRun refs_of_cell(const Tree& tree, std::uint32_t node) {
  const Node& last = tree.nodes[last_leaf(tree, node)];
  while (!tree.nodes[node].is_leaf()) node = tree.nodes[node].left;
  const std::uint32_t first = tree.nodes[node].left;
  return {first, last.left + last.right - first};
}

}  // namespace kdray::kdtree
