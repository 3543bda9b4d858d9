// What    32 equal bins along each axis of a cell's contents, and how many references begin and end in each.
// Shape   Beginnings are counted from the lower end and ends from the upper one, both rounded towards their
//         end: a bound on the plane between two bins then counts as a partition by that plane treats it.
//         Counts may be off by one where rounding moves a bound across a plane: they choose a plane and
//         decide nothing else.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "accel/kdtree/reference.h"

namespace kdray::kdtree::binned {

inline constexpr int kBins = 32;

// Which references of a cell of n are counted: some hundreds say as well where to split as all of them do.
inline std::size_t sample_stride(std::size_t n) {
  constexpr std::size_t kEnough = 512, kMost = 32;
  return std::clamp<std::size_t>(std::bit_floor(n / kEnough), 1, kMost);
}

struct BinGrid {
  // The fourth lane belongs to the reference's number: it gets a value that makes no denormal of it.
  alignas(16) std::array<float, 4> lo{0, 0, 0, 1}, hi{0, 0, 0, 1}, scale{0, 0, 0, 0};

  float plane(int axis, int bin) const {
    const auto k = static_cast<std::size_t>(axis);
    return lo[k] + (hi[k] - lo[k]) * (static_cast<float>(bin) / kBins);
  }
};

inline BinGrid make_bin_grid(const Bounds& contents) {
  BinGrid grid;
  for (std::size_t k = 0; k < 3; ++k) {
    grid.lo[k] = contents.lo[k];
    grid.hi[k] = contents.hi[k];
    const float scale = kBins / (grid.hi[k] - grid.lo[k]);
    // A very thin axis is one bin.
    grid.scale[k] = scale > 0 && scale < 1e37f ? scale : 0;
  }
  return grid;
}

struct BinCounts {
  alignas(64) std::array<std::array<std::uint32_t, kBins>, 3> begins{};
  alignas(64) std::array<std::array<std::uint32_t, kBins>, 3> ends{};

  void add(const BinCounts& other) {
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t b = 0; b < kBins; ++b) {
        begins[k][b] += other.begins[k][b];
        ends[k][b] += other.ends[k][b];
      }
  }
};

}  // namespace kdray::kdtree::binned
