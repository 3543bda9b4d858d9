// What    The wide form of a scene whose triangles have moved: the nodes and leaves of the form as it was
//         built, with bounds and corners of where the triangles are now; and what a ray is expected to cost.
// Shape   What doesn't change is shared with the old form, as blocks of other kinds, or copied, as the words
//         of children. Bounds are those of *pieces*, joined from the leaves to the root; orders follow them
//         (collapse.h), and the stack's size follows the orders. A piece is the part of its triangle that a
//         lane of a leaf stands for, in the weights of the triangle's corners, so that it moves with them. It
//         is a convex polygon of up to six corners: what a box cuts out of a triangle; where that has more
//         corners, the hexagon around it whose sides go along the triangle's. A corner is the weights of the
//         triangle's second and third corner, a byte each, in 255ths. Those of a block are rows of bytes, a
//         lane beside the other.
// Why     A walk asks no more of the form than that some leaf whose bounds hold a place of a primitive names
//         it (docs/design/refit.md): orders may be wrong, and bounds may overlap.
// Errors  Every place of a triangle is in one of its pieces, whatever the rounding: the tree has a leaf whose
//         contents hold it (docs/design/kdtree.md), and a piece is cut by its leaf's contents, which are
//         taken 2^-40 larger for it. Weights are rounded to the nearest byte, and bounds are widened by as
//         much as that may change. In a moved triangle the place of the same weights is in the same piece.
#pragma once

#include <array>
#include <cstdint>

#include "accel/flatten/leaf_block.h"
#include "accel/flatten/wide.h"
#include "base/box.h"
#include "base/memory.h"

namespace kdray::flatten {

// ---- Pieces

struct Piece {
  static constexpr std::size_t kCorners = 6;
  static constexpr std::uint8_t kNowhere = 255;  // both weights of a corner: the sum would be 2

  using Corner = std::array<std::uint8_t, 2>;
  std::array<Corner, kCorners> corners;  // fewer ones are repeated

  static Piece whole() { return {{{{0, 0}, {255, 0}, {0, 255}, {0, 0}, {0, 0}, {0, 0}}}}; }
  // Returns the piece of a triangle that doesn't reach its leaf, as cautious clipping leaves some.
  static Piece nothing();
  bool operator==(const Piece&) const = default;
};

// Returns the part of a triangle that lies in a box.
Piece piece_of(const TriangleInBlock& t, const Box& box);

class Pieces {
 public:
  static constexpr std::size_t kRows = 2 * Piece::kCorners;

  // Takes a form as it was built: its leaves' bounds are those of their contents.
  explicit Pieces(const WideForm& form);

  const std::uint8_t* of_block(std::size_t i) const { return bytes_.data() + i * kRows * block_; }
  std::size_t bytes() const { return bytes_.size(); }

 private:
  void cut_leaf(const WideForm& form, layout::u32 leaf, const Box& box);

  std::size_t block_;
  RawVector<std::uint8_t> bytes_;
};

// Returns the bounds of n moved triangles' pieces: `words` are the block's, `pieces` its rows.
Box bounds_of_pieces(const layout::u32* words, const std::uint8_t* pieces, std::uint32_t n,
                     std::uint32_t block);

// ---- Refits

// Returns the expected steps of a ray that meets the root, by the surface-area heuristic: a node is one step,
// and so is a block of a leaf. 0 where the root has no surface.
double expected_cost(const WideForm& form);

struct Refit {
  WideForm form;
  double cost = 0;  // expected_cost() of it
};

// `triangles` are those that the form was built of, in the same order, wherever they are now.
Refit refit(const WideForm& form, const Pieces& pieces, const Array<layout::Triangle>& triangles);

}  // namespace kdray::flatten
