// What    The order in which adaptive sampling goes through a picture's pixels: blocks of 32x32 along a
//         curve, and in a block as the device goes through a tile (kernels/raygen/place.clh), so that sixteen
//         samples in a row make a packet.
#pragma once

#include <algorithm>
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

}  // namespace kdray::adaptive
