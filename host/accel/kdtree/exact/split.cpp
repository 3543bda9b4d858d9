#include "accel/kdtree/exact/exact.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

namespace kdray::kdtree {

// ---- Small cells: every plane is counted against every reference, with no sort and no branch. Most cells of
// a tree are small, so this is where a build spends its time: lanes are planes, eight at a time.

namespace {

constexpr std::size_t kLanes = 8;

struct AxisIntervals {
  float lo[kSmallSweep], hi[kSmallSweep];
  float planes[2 * kSmallSweep + kLanes];
  std::size_t n_planes = 0;
  bool has_planar = false;
};

// Collects the intervals and the planes strictly inside the cell.
void collect(std::span<const BoundedRef> refs, const AxisCosts& costs, int axis, AxisIntervals& out) {
  bool planar = false;
  std::size_t n = 0;
  for (std::size_t i = 0; i < refs.size(); ++i) {
    const float lo = refs[i].lo[axis], hi = refs[i].hi[axis];
    out.lo[i] = lo;
    out.hi[i] = hi;
    out.planes[n] = lo;
    n += costs.inside(lo);
    out.planes[n] = hi;
    n += costs.inside(hi);
    planar |= lo == hi;
  }
  out.n_planes = n;
  out.has_planar = planar;
  for (std::size_t i = 0; i < kLanes; ++i) out.planes[n + i] = 0;
}

void count_lanes(const AxisIntervals& in, std::size_t n_refs, const float* planes, std::int32_t* n_below,
                 std::int32_t* n_above) {
  std::int32_t below[kLanes] = {}, above[kLanes] = {};
  for (std::size_t i = 0; i < n_refs; ++i) {
    const float lo = in.lo[i], hi = in.hi[i];
    for (std::size_t k = 0; k < kLanes; ++k) below[k] += lo < planes[k];
    for (std::size_t k = 0; k < kLanes; ++k) above[k] += hi > planes[k];
  }
  for (std::size_t k = 0; k < kLanes; ++k) n_below[k] = below[k], n_above[k] = above[k];
}

void sweep_thick(const AxisIntervals& in, std::size_t n_refs, const AxisCosts& costs, int axis, Split& best) {
  for (std::size_t first = 0; first < in.n_planes; first += kLanes) {
    std::int32_t n_below[kLanes], n_above[kLanes];
    count_lanes(in, n_refs, in.planes + first, n_below, n_above);
    const std::size_t last = std::min(kLanes, in.n_planes - first);
    for (std::size_t k = 0; k < last; ++k) {
      const float s = in.planes[first + k];
      const Split split{axis, s, true, costs(s, n_below[k], n_above[k])};
      if (better(split, best)) best = split;
    }
  }
}

// Sweeps an axis, a rare one, with references that lie in a plane; planes on the cell's boundary count too.
void sweep_planar(const AxisIntervals& in, std::size_t n_refs, const AxisCosts& costs, int axis,
                  Split& best) {
  for (std::size_t c = 0; c < 2 * n_refs; ++c) {
    const float s = c < n_refs ? in.lo[c] : in.hi[c - n_refs];
    std::uint32_t n_below = 0, n_planar = 0, n_above = 0;
    for (std::size_t i = 0; i < n_refs; ++i) {
      n_below += in.lo[i] < s;
      n_above += in.hi[i] > s;
      n_planar += in.lo[i] == s && in.hi[i] == s;
    }
    offer_plane(costs, axis, s, n_below, n_planar, n_above, best);
  }
}

}  // namespace

Split small_sweep(std::span<const BoundedRef> refs, const Bounds& cell, const BuildConfig& config) {
  Split best;
  AxisIntervals intervals;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(cell.lo[axis] < cell.hi[axis])) continue;
    const AxisCosts costs(config, cell, axis);
    collect(refs, costs, axis, intervals);
    if (intervals.has_planar) {
      sweep_planar(intervals, refs.size(), costs, axis, best);
    } else {
      sweep_thick(intervals, refs.size(), costs, axis, best);
    }
  }
  return best;
}

// ---- Medians

namespace {

// Returns the longest first; of equal ones the lower first.
std::array<int, 3> axes_by_length(const Bounds& cell) {
  const auto length = [&](int k) { return static_cast<double>(cell.hi[k]) - cell.lo[k]; };
  std::array<int, 3> axes = {0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return length(a) > length(b); });
  return axes;
}

float middle(float lo, float hi) {
  return static_cast<float>(std::midpoint(static_cast<double>(lo), static_cast<double>(hi)));
}

float median_of_centers(std::span<const BoundedRef> refs, int axis) {
  std::vector<float> centers;
  centers.reserve(refs.size());
  for (const BoundedRef& r : refs) centers.push_back(middle(r.lo[axis], r.hi[axis]));
  const auto median = centers.begin() + static_cast<std::ptrdiff_t>(centers.size() / 2);
  std::nth_element(centers.begin(), median, centers.end());
  return *median;
}

bool cuts(const Bounds& cell, int axis, float s) {
  return cell.lo[axis] < s && s < cell.hi[axis];
}

// Returns whether any reference is on one side alone: otherwise a split only doubles them.
bool separates(std::span<const BoundedRef> refs, int axis, float s) {
  return std::any_of(refs.begin(), refs.end(),
                     [&](const BoundedRef& r) { return r.hi[axis] <= s || r.lo[axis] >= s; });
}

Split split_at(int axis, float position) {
  Split split;
  split.axis = axis;
  split.position = position;
  return split;
}

Split spatial_median(const Bounds& cell) {
  const int axis = axes_by_length(cell)[0];
  const float s = middle(cell.lo[axis], cell.hi[axis]);
  return cuts(cell, axis, s) ? split_at(axis, s) : Split{};
}

Split object_median(std::span<const BoundedRef> refs, const Bounds& cell) {
  for (const int axis : axes_by_length(cell))
    if (const float s = median_of_centers(refs, axis); cuts(cell, axis, s) && separates(refs, axis, s))
      return split_at(axis, s);
  return {};
}

}  // namespace

Split median_split(std::span<const BoundedRef> refs, const Bounds& cell, SplitRule rule) {
  if (refs.size() <= kMedianLeaf) return {};
  return rule == SplitRule::spatial_median ? spatial_median(cell) : object_median(refs, cell);
}

Split find_split(std::span<const BoundedRef> refs, const Bounds& cell, const BuildConfig& config,
                 SweepScratch& scratch) {
  // A cell without area is met by almost no ray, and its costs are 0/0.
  if (refs.empty() || !(half_area(cell) > 0)) return {};
  return refs.size() <= kSmallSweep ? small_sweep(refs, cell, config) : sweep(refs, cell, config, scratch);
}

}  // namespace kdray::kdtree
