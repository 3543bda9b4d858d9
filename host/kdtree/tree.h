// What    A kd-tree over triangles, spheres and cones, as the builder leaves it and flatten/ packs it.
// Shape   nodes[0] is the root; a leaf names a run of `refs`. A reference is the kind in the top two bits and the
//         index into that kind's array of scene::Geometry below them; within a leaf they ascend.
#pragma once

#include <cstdint>
#include "base/raw_vector.h"
#include "math/box.h"
#include "scene/geometry.h"

namespace kdray::kdtree {

using Ref = std::uint32_t;
inline constexpr std::uint32_t kRefIndexBits = 30;
inline constexpr Ref make_ref(scene::PrimitiveKind kind, std::uint32_t index) {
  return (static_cast<std::uint32_t>(kind) << kRefIndexBits) | index;
}
inline constexpr scene::PrimitiveKind ref_kind(Ref r) {
  return static_cast<scene::PrimitiveKind>(r >> kRefIndexBits);
}
inline constexpr std::uint32_t ref_index(Ref r) {
  return r & ((1u << kRefIndexBits) - 1);
}

struct Node {
  static constexpr std::uint32_t kLeaf = 3;
  std::uint32_t axis = kLeaf;  // 0, 1, 2: the split plane's axis; kLeaf
  float split = 0;             // the plane's coordinate
  std::uint32_t left = 0;      // inner: child below the plane;  leaf: first reference
  std::uint32_t right = 0;     // inner: child above the plane;  leaf: number of references
  bool is_leaf() const { return axis == kLeaf; }
};

struct Tree {
  RawVector<Node> nodes;
  RawVector<Ref> refs;
  RawVector<Box>
      contents;       // of each node: bounds of what its leaves hold, clipped to their cells; empty boxes too
  Box bounds;         // of the geometry; the root's cell
  int max_depth = 0;  // of any leaf; a lone root leaf has depth 0
};

}  // namespace kdray::kdtree
