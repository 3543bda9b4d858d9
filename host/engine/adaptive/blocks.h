// What    The order in which adaptive sampling goes through a picture's pixels: blocks of 32x32 along a
//         curve, and in a block as the device goes through a tile (kernels/raygen/place.clh), so that sixteen
//         samples in a row make a packet.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace kdray::adaptive {

struct Size {
  std::uint32_t width = 0, height = 0;

  std::size_t pixels() const { return std::size_t{width} * height; }
};

class Blocks {
 public:
  static constexpr std::uint32_t kSide = 32;

  struct Corner {
    std::uint32_t x, y;
  };

  explicit Blocks(Size size);

  Size size() const { return size_; }
  Corner corner(std::size_t block) const { return corners_[block]; }
  std::size_t count() const { return corners_.size(); }

  // Calls take(pixel, x, y) for the block's pixels.
  template <class Take>
  void for_each(std::size_t block, const Take& take) const {
    const Corner corner = corners_[block];
    for (std::uint32_t place = 0; place < kSide * kSide; ++place) {
      const std::uint32_t x = corner.x + even_bits(place), y = corner.y + even_bits(place >> 1);
      if (x < size_.width && y < size_.height) take(std::size_t{y} * size_.width + x, x, y);
    }
  }

  // The same, row by row, for what doesn't depend on the order.
  template <class Take>
  void for_each_by_rows(std::size_t block, const Take& take) const {
    const Corner corner = corners_[block];
    const std::uint32_t end_x = std::min(corner.x + kSide, size_.width),
                        end_y = std::min(corner.y + kSide, size_.height);
    for (std::uint32_t y = corner.y; y < end_y; ++y)
      for (std::uint32_t x = corner.x; x < end_x; ++x) take(std::size_t{y} * size_.width + x, x, y);
  }

  // The block itself and those that touch it.
  std::vector<std::size_t> around(std::size_t block) const;

 private:
  static std::uint32_t even_bits(std::uint32_t v) {
    v &= 0x55555555u;
    v = (v | (v >> 1)) & 0x33333333u;
    v = (v | (v >> 2)) & 0x0f0f0f0fu;
    return (v | (v >> 4)) & 0x00ff00ffu;
  }

  Size size_;
  std::uint32_t n_columns_, n_rows_;
  std::vector<Corner> corners_;
  std::vector<std::size_t> number_of_;  // by row and column
};

// Sums of a value over each pixel's eight neighbours, for the pixels of a block. Sums are made by columns
// of three, each of which serves three pixels. Outside of the picture the value is 0, so that borders need
// no cases of their own.
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
