// What    The split of a small cell: every plane is counted against every reference, with no sort and no
//         branch.
// Shape   Most cells of a tree are small, so this is where a build spends its time: lanes are planes, eight
//         at a time.

#include <cstdint>

#include "accel/kdtree/exact/split.h"

namespace kdray::kdtree {

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

// The rare axis with references that lie in a plane; planes on the cell's boundary count too.
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

}  // namespace kdray::kdtree
