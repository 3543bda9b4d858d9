// What    Which part of its triangle each lane of the wide form's leaves stands for: a *piece*, in the weights
//         of the triangle's corners, so that it moves with them. It is what a refit makes new bounds of.
// Shape   A piece is all places of the triangle whose three weights lie within lo and hi, in 256ths: a
//         hexagon at most. Those of a block are six rows of bytes: lo of each corner, then hi less one.
// Errors  Every place of a triangle is in one of its pieces, whatever the rounding: the tree has a leaf whose
//         contents hold it (docs/design/kdtree.md), and a piece holds what is within its leaf's contents,
//         which are taken 2^-40 larger for it. Of a moved triangle the place of the same weights is in the
//         same piece.
#pragma once

#include <array>
#include <cstdint>

#include "base/raw_vector.h"
#include "flatten/wide.h"
#include "math/box.h"

namespace kdray::flatten {

struct Piece {
  std::array<std::uint8_t, 3> lo{}, last{};  // last = hi - 1

  static Piece whole() { return {{0, 0, 0}, {255, 255, 255}}; }
  // That of a triangle which doesn't reach its leaf, as cautious clipping leaves some.
  static Piece nothing() { return {{255, 255, 255}, {0, 0, 0}}; }
  bool operator==(const Piece&) const = default;
};

// The part of a triangle that lies in a box.
Piece piece_of(const layout::Triangle& t, const Box& box);

class Pieces {
 public:
  static constexpr std::size_t kRows = 6;

  // Of a form as it was built: its leaves' bounds are those of their contents.
  Pieces(const WideForm& form, const Array<layout::Triangle>& triangles);

  const std::uint8_t* of_block(std::size_t i) const { return bytes_.data() + i * kRows * block_; }
  std::size_t bytes() const { return bytes_.size(); }

 private:
  void cut(const WideForm& form, const Array<layout::Triangle>& triangles, std::size_t node);

  std::size_t block_;
  RawVector<std::uint8_t> bytes_;
};

// The bounds of n moved triangles' pieces: `words` are the block's, `pieces` its rows.
Box bounds_of_pieces(const layout::u32* words, const std::uint8_t* pieces, std::uint32_t n, std::uint32_t block);

}  // namespace kdray::flatten
