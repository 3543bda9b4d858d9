// What    The words of the wide form (kernels/layout/wide.layout.h), written and read again: a node's
//         children, a leaf's blocks, and the rows of a block of triangles. Builds and refits write the same.
// Shape   A block of triangles is KDRAY_TRIANGLE_ROWS rows of `block` words, 4 or 8: what is written from
//         corners, then what follows from them for all lanes at once; the last row holds the indices.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "accel/flatten/openings.h"
#include "accel/flatten/wide.h"
#include "base/box.h"
#include "base/memory.h"
#include "layout/instances.layout.h"
#include "layout/primitives.layout.h"
#include "layout/tree.layout.h"
#include "layout/wide.layout.h"
#include "scene/model/zero_area.h"

namespace kdray::flatten {

// ---- Nodes

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

// ---- Rows of triangles

inline layout::u32 bits(float v) {
  return std::bit_cast<layout::u32>(v);
}

// A triangle of a block, of which lane 0 of row 0 is at `rows`: vertex v, axis k in row 3 v + k.
struct TriangleInBlock {
  const layout::u32* rows;
  std::uint32_t block;

  float operator()(int v, int k) const {
    return std::bit_cast<float>(rows[static_cast<std::uint32_t>(3 * v + k) * block]);
  }
};

// The factor of sign_limit (primitives/triangle/intersect.clh) that the triangle alone decides, or more:
// |n|_1 of the normal that the kernels compute in float, and what is added for the tilt, at most 8 times the
// square of the edges' largest component. With u = 2^-24, an edge is off by u of itself, a product of two by
// 3u, a component by 3u of the products' sizes and u of itself: here and there together by less than 8u of
// `size` and 4u of `sum`. What underflows is below 2^-140.
inline float sign_limit_factor(const TriangleInBlock& t) {
  float e[2][3];
  for (int k = 0; k < 3; ++k) {
    e[0][k] = t(1, k) - t(0, k);
    e[1][k] = t(2, k) - t(0, k);
  }
  float sum = 0, size = 0;
  for (int k = 0; k < 3; ++k) {
    const int i = k == 2 ? 0 : k + 1, j = i == 2 ? 0 : i + 1;
    const float p = e[0][i] * e[1][j], q = e[0][j] * e[1][i];
    sum += std::abs(p - q);
    size += std::abs(p) + std::abs(q);
  }
  float edge = 0;
  for (const auto& components : e)
    for (const float c : components) edge = std::max(edge, std::abs(c));
  return (sum + 8 * edge * edge) * (1 + 0x1p-20f) + (size * 0x1p-20f + 0x1p-140f);
}

// Whether its plane lies across an axis: the kernels then take the distance from that plane alone (level_t).
inline bool is_level(const TriangleInBlock& t) {
  int level = 0;  // numbers, not conditions: no branches
  for (int k = 0; k < 3; ++k)
    level |= static_cast<int>(t(0, k) == t(1, k)) & static_cast<int>(t(1, k) == t(2, k));
  return level != 0;
}

// Writes KDRAY_ROW_TRIANGLE_LIMIT of a block of kLanes triangles: the factor of each one's limit, negative
// where the triangle is level, so that kernels learn both from one row. The compiler makes vectors of it.
template <std::uint32_t kLanes>
void write_limits(layout::u32* rows) {
  std::array<layout::u32, kLanes> limits;
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    const TriangleInBlock t{rows + lane, kLanes};
    const float factor = sign_limit_factor(t);
    limits[lane] = bits(is_level(t) ? -factor : factor);
  }
  std::copy(limits.begin(), limits.end(), rows + KDRAY_ROW_TRIANGLE_LIMIT * kLanes);
}

// The rows of a triangle in its block, without its limit and its index.
inline std::array<float, KDRAY_TRIANGLE_ROWS - 2> rows_of(const layout::Triangle& t) {
  return {t.v[0][0], t.v[0][1], t.v[0][2], t.v[1][0], t.v[1][1], t.v[1][2], t.v[2][0], t.v[2][1], t.v[2][2]};
}

// Lanes without primitive: NaN but for the index.
inline void clear_lanes(std::uint32_t first, std::uint32_t block, std::size_t n_rows, layout::u32* words) {
  for (std::size_t row = 0; row < n_rows; ++row)
    std::fill(words + row * block + first, words + (row + 1) * block, bits(NAN));
  std::fill(words + n_rows * block + first, words + (n_rows + 1) * block, KDRAY_WIDE_LAST);
}

// The row of limits, where all others are written and the first n lanes hold triangles. A zero-area
// triangle has no normal: all that is asked near t = 0 is how far it is from the ray's origin (zero_area_t).
inline void finish_triangles(const Array<layout::Triangle>& triangles, std::uint32_t n, std::uint32_t block,
                             layout::u32* words) {
  block == 8 ? write_limits<8>(words) : write_limits<4>(words);
  layout::u32* const limits = words + KDRAY_ROW_TRIANGLE_LIMIT * block;
  const layout::u32* const indices = words + KDRAY_ROW_TRIANGLE_INDEX * block;
  for (std::uint32_t lane = 0; lane < n; ++lane)
    if (scene::is_zero_area(triangles[indices[lane] & KDRAY_REF_INDEX_MASK])) limits[lane] = bits(INFINITY);
  std::fill(limits + n, limits + block, bits(NAN));
}

}  // namespace kdray::flatten
