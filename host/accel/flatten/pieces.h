// What    Which part of its triangle each lane of the wide form's leaves stands for: a *piece*, in the
//         weights of the triangle's corners, so that it moves with them. It is what a refit makes new bounds
//         of.
// Shape   A piece is a convex polygon of up to six corners: what a box cuts out of a triangle; where that has
//         more corners, the hexagon around it whose sides go along the triangle's. A corner is the weights of
//         the triangle's second and third corner, a byte each, in 255ths. Those of a block are rows of bytes,
//         a lane beside the other.
// Errors  Every place of a triangle is in one of its pieces, whatever the rounding: the tree has a leaf whose
//         contents hold it (docs/design/kdtree.md), and a piece is cut by its leaf's contents, which are
//         taken 2^-40 larger for it. Weights are rounded to the nearest byte, and bounds are widened by what
//         that may be. Of a moved triangle the place of the same weights is in the same piece.
#pragma once

#include <array>
#include <cstdint>

#include "accel/flatten/triangle_block.h"
#include "accel/flatten/wide.h"
#include "base/box.h"
#include "base/raw_vector.h"

namespace kdray::flatten {

struct Piece {
  static constexpr std::size_t kCorners = 6;
  static constexpr std::uint8_t kNowhere = 255;  // both weights of a corner: the sum would be 2

  using Corner = std::array<std::uint8_t, 2>;
  std::array<Corner, kCorners> corners;  // fewer ones are repeated

  static Piece whole() { return {{{{0, 0}, {255, 0}, {0, 255}, {0, 0}, {0, 0}, {0, 0}}}}; }
  // That of a triangle which doesn't reach its leaf, as cautious clipping leaves some.
  static Piece nothing();
  bool operator==(const Piece&) const = default;
};

// The part of a triangle that lies in a box.
Piece piece_of(const TriangleInBlock& t, const Box& box);

class Pieces {
 public:
  static constexpr std::size_t kRows = 2 * Piece::kCorners;

  // Of a form as it was built: its leaves' bounds are those of their contents.
  explicit Pieces(const WideForm& form);

  const std::uint8_t* of_block(std::size_t i) const { return bytes_.data() + i * kRows * block_; }
  std::size_t bytes() const { return bytes_.size(); }

 private:
  void cut_leaf(const WideForm& form, layout::u32 leaf, const Box& box);

  std::size_t block_;
  RawVector<std::uint8_t> bytes_;
};

// The bounds of n moved triangles' pieces: `words` are the block's, `pieces` its rows.
Box bounds_of_pieces(const layout::u32* words, const std::uint8_t* pieces, std::uint32_t n,
                     std::uint32_t block);

}  // namespace kdray::flatten
