// What    Bins along an axis: where a position falls, and how many references begin and end in each.
// Shape   A bin's number never falls as the position grows, so counts over whole bins are exact statements
//         about planes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace kdray::kdtree {

inline constexpr int kMaxBins = 512;

// Position -> bin along an axis. Every operation is monotone under rounding, so x < y never lands in a later
// bin than y.
struct BinMap {
  float origin = 0, scale = 0;
  int n_bins = 1;  // 0: nothing to split along this axis

  int operator()(float x) const { return std::clamp(static_cast<int>((x - origin) * scale), 0, n_bins - 1); }
  // Positions that no float of the bin is below or above: (x - origin)*scale is off by 2^-22 of its value,
  // which is less than 1e-3 of a bin for up to 4096 of them.
  double lower_edge(int bin) const { return n_bins == 1 ? -INFINITY : origin + (bin - 1e-3) / scale; }
  double upper_edge(int bin) const { return n_bins == 1 ? INFINITY : origin + (bin + 1 + 1e-3) / scale; }
};

inline BinMap make_bin_map(float lo, float hi, int n_bins) {
  const float scale = static_cast<float>(n_bins) / (hi - lo);
  // A very thin axis, or one whose length overflows, is one bin.
  return scale > 1e-30f && scale < 1e30f ? BinMap{lo, scale, n_bins} : BinMap{};
}

struct Histogram {
  std::uint32_t starts[3][kMaxBins];  // references by the bin of lo
  std::uint32_t ends[3][kMaxBins];    // and of hi

  void clear(int n_bins) {
    for (int axis = 0; axis < 3; ++axis) {
      std::fill_n(starts[axis], n_bins, 0u);
      std::fill_n(ends[axis], n_bins, 0u);
    }
  }
};

// There are about 16 references to a bin: bins enough to skip most of them, few enough to be cheap to bound.
inline int bins_for(std::size_t n) {
  int bins = 32;
  while (bins < kMaxBins && static_cast<std::size_t>(bins) * 16 < n) bins *= 2;
  return bins;
}

}  // namespace kdray::kdtree
