// What    Sums of a value over each pixel's eight neighbours, for the pixels of a block.
// Shape   Sums are made by columns of three, each of which serves three pixels. Outside of the picture the
//         value is 0, so that borders need no cases of their own.
#pragma once

#include <array>
#include <cstdint>

#include "engine/adaptive/blocks.h"

namespace kdray::adaptive {

class Neighbours {
 public:
  // Calls value(pixel) for the pixels of the block and those around it.
  template <class Value>
  Neighbours(const Blocks& blocks, std::size_t block, const Value& value) : corner_(blocks.corner(block)) {
    const Size size = blocks.size();
    for (std::uint32_t row = 0; row < kRows; ++row) {
      const std::int64_t y = std::int64_t{corner_.y} + row - 1;
      if (y < 0 || y >= size.height) continue;
      const std::int64_t first = std::int64_t{corner_.x} - 1;
      const std::int64_t begin = first < 0 ? 0 : first,
                         end = std::min<std::int64_t>(first + kRows, size.width);
      for (std::int64_t x = begin; x < end; ++x)
        values_[row][static_cast<std::size_t>(x - first)] =
            value(static_cast<std::size_t>(y * size.width + x));
    }
    for (std::uint32_t row = 1; row + 1 < kRows; ++row)
      for (std::uint32_t x = 0; x < kRows; ++x)
        columns_[row][x] = values_[row - 1][x] + values_[row][x] + values_[row + 1][x];
  }

  // The sum over the neighbours of a pixel of the block.
  float sum(std::uint32_t x, std::uint32_t y) const {
    const std::uint32_t u = x - corner_.x + 1, v = y - corner_.y + 1;
    return columns_[v][u - 1] + columns_[v][u + 1] + (values_[v - 1][u] + values_[v + 1][u]);
  }

 private:
  static constexpr std::uint32_t kRows = Blocks::kSide + 2;
  using Rows = std::array<std::array<float, kRows>, kRows>;

  Blocks::Corner corner_;
  Rows values_{}, columns_{};
};

// How many neighbours a pixel has: 8, but fewer at the picture's borders.
inline std::uint32_t neighbours_of(std::uint32_t x, std::uint32_t y, Size size) {
  const auto in_a_line = [](std::uint32_t at, std::uint32_t n) { return 1u + (at > 0) + (at + 1 < n); };
  return in_a_line(x, size.width) * in_a_line(y, size.height) - 1;
}

}  // namespace kdray::adaptive
