#include "engine/adaptive/blocks.h"

#include <algorithm>

#include "engine/wavefront/tile_order.h"

namespace kdray::adaptive {

Blocks::Blocks(Size size)
    : size_(size),
      n_columns_((size.width + kSide - 1) / kSide),
      n_rows_((size.height + kSide - 1) / kSide),
      number_of_(std::size_t{n_columns_} * n_rows_) {
  for (const layout::u32 entry : wavefront::tile_curve(n_columns_, 0, n_rows_)) {
    const std::uint32_t column = KDRAY_TILE_COLUMN(entry), row = KDRAY_TILE_ROW(entry);
    number_of_[std::size_t{row} * n_columns_ + column] = corners_.size();
    corners_.push_back({column * kSide, row * kSide});
  }
}

std::vector<std::size_t> Blocks::around(std::size_t block) const {
  const std::uint32_t column = corners_[block].x / kSide, row = corners_[block].y / kSide;
  std::vector<std::size_t> blocks;
  for (std::uint32_t y = row - std::min(row, 1u); y <= std::min(row + 1, n_rows_ - 1); ++y)
    for (std::uint32_t x = column - std::min(column, 1u); x <= std::min(column + 1, n_columns_ - 1); ++x)
      blocks.push_back(number_of_[std::size_t{y} * n_columns_ + x]);
  return blocks;
}

}  // namespace kdray::adaptive
