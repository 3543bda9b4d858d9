// What    The split of a large cell, in two passes over its references instead of a sort: counts in bins give
//         each bin's planes a lower bound of their cost and the cell an upper bound of its best cost; only in
//         bins whose lower bound is not above it are the events collected, sorted and swept.
// Shape   The result is exact: bins decide where to look, never which plane wins. Counts are integers and
//         events are sorted, so the result does not depend on the order of references or on threads. A cell
//         takes O(n) where costs are spread, O(n log n) where they are all in one bin.
// Source  The sweep: Wald and Havran 2006, algorithm 4. Bounding by bins: branch and bound.

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "accel/kdtree/exact/exact.h"

namespace kdray::kdtree {

namespace {

// ---- Bins along an axis. A bin's number never falls as the position grows, so counts over whole bins are
// exact statements about planes.

constexpr int kMaxBins = 512;

// Position -> bin along an axis. Every operation is monotone under rounding, so x < y never lands in a later
// bin than y.
struct BinMap {
  float origin = 0, scale = 0;
  int n_bins = 1;  // 0: nothing to split along this axis

  int operator()(float x) const { return std::clamp(static_cast<int>((x - origin) * scale), 0, n_bins - 1); }
  // Return positions that no float of the bin is below or above: (x - origin)*scale is off by 2^-22 of its
  // value, which is less than 1e-3 of a bin for up to 4096 of them.
  double lower_edge(int bin) const { return n_bins == 1 ? -INFINITY : origin + (bin - 1e-3) / scale; }
  double upper_edge(int bin) const { return n_bins == 1 ? INFINITY : origin + (bin + 1 + 1e-3) / scale; }
};

BinMap make_bin_map(float lo, float hi, int n_bins) {
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

// Returns the number of bins for n references, about 16 to a bin: enough to skip most of them, few enough to
// be cheap to bound.
int bins_for(std::size_t n) {
  int bins = 32;
  while (bins < kMaxBins && static_cast<std::size_t>(bins) * 16 < n) bins *= 2;
  return bins;
}

// ---- The sweep

constexpr std::size_t kChunk = 8192;  // references to a parallel task

// Rounding in a lower bound is at most some 2^-50 of it; this is far more, and keeps hardly any bin in vain.
constexpr double kSlack = 1 - 1e-12;

// Which bins of an axis may hold the best plane, and the counts at a bin's beginning.
struct AxisBins {
  bool alive[kMaxBins];
  std::uint32_t n_below[kMaxBins];  // references with lo in an earlier bin
  std::uint32_t n_above[kMaxBins];  // references with hi in this bin or a later one
  double lower_bound[kMaxBins];
};

Bounds extent_of(std::span<const BoundedRef> refs) {
  Bounds b = refs[0].bounds();
  for (const BoundedRef& r : refs) b = hull(b, r.bounds());
  return b;
}

std::size_t n_chunks(std::size_t n) {
  return (n + kChunk - 1) / kChunk;
}

template <class F>
void for_chunks(std::size_t n, F f) {
  tbb::parallel_for(std::size_t{0}, n_chunks(n),
                    [&](std::size_t c) { f(c, c * kChunk, std::min(n, (c + 1) * kChunk)); });
}

class Sweep {
 public:
  Sweep(std::span<const BoundedRef> refs, const Bounds& cell, const BuildConfig& config,
        SweepScratch& scratch)
      : refs_(refs),
        costs_{AxisCosts(config, cell, 0), AxisCosts(config, cell, 1), AxisCosts(config, cell, 2)},
        scratch_(scratch),
        upper_bound_(config.cost_intersect * LeafCost(config)(static_cast<std::uint32_t>(refs.size()))) {
    set_maps(cell);
  }

  Split run() {
    count();
    bound();
    collect();
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (maps_[axis].n_bins > 0) sweep_axis(axis, best);
    }
    return best;
  }

 private:
  void set_maps(const Bounds& cell) {
    const Bounds extent = large() ? large_extent() : extent_of(refs_);
    n_bins_ = bins_for(refs_.size());
    for (int axis = 0; axis < 3; ++axis) {
      maps_[axis] = make_bin_map(extent.lo[axis], extent.hi[axis], n_bins_);
      if (!(cell.lo[axis] < cell.hi[axis])) maps_[axis].n_bins = 0;
    }
  }

  bool large() const { return refs_.size() > 2 * kChunk; }

  Bounds large_extent() const {
    std::vector<Bounds> parts(n_chunks(refs_.size()));
    for_chunks(refs_.size(), [&](std::size_t c, std::size_t first, std::size_t last) {
      parts[c] = extent_of(refs_.subspan(first, last - first));
    });
    Bounds b = parts[0];
    for (const Bounds& p : parts) b = hull(b, p);
    return b;
  }

  void count_range(std::span<const BoundedRef> refs, Histogram& h) const {
    h.clear(n_bins_);
    for (int axis = 0; axis < 3; ++axis) {
      const BinMap map = maps_[axis];
      if (map.n_bins <= 1) {
        h.starts[axis][0] = h.ends[axis][0] = static_cast<std::uint32_t>(refs.size());
        continue;
      }
      for (const BoundedRef& r : refs) {
        ++h.starts[axis][map(r.lo[axis])];
        ++h.ends[axis][map(r.hi[axis])];
      }
    }
  }

  void count() {
    if (!large()) return count_range(refs_, histogram_);
    std::vector<Histogram> parts(n_chunks(refs_.size()));
    for_chunks(refs_.size(), [&](std::size_t c, std::size_t first, std::size_t last) {
      count_range(refs_.subspan(first, last - first), parts[c]);
    });
    histogram_.clear(n_bins_);
    for (const Histogram& p : parts) {
      for (int axis = 0; axis < 3; ++axis) {
        for (int b = 0; b < n_bins_; ++b) {
          histogram_.starts[axis][b] += p.starts[axis][b];
          histogram_.ends[axis][b] += p.ends[axis][b];
        }
      }
    }
  }

  // Finds for each bin a cost that none of its planes is below, and for the cell one that its best plane is
  // not above. Bins that can't have that plane are dead.
  void bound() {
    for (int axis = 0; axis < 3; ++axis) {
      std::uint32_t below = 0, above = static_cast<std::uint32_t>(refs_.size());
      for (int b = 0; b < maps_[axis].n_bins; ++b) {
        bins_[axis].n_below[b] = below;
        bins_[axis].n_above[b] = above;
        below += histogram_.starts[axis][b];
        above -= histogram_.ends[axis][b];
        bound_bin(axis, b, below, above);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (int b = 0; b < maps_[axis].n_bins; ++b)
        bins_[axis].alive[b] = bins_[axis].lower_bound[b] <= upper_bound_;
    }
  }

  // `below_end` counts references with lo in this bin or before, `above_end` those with hi in a later bin.
  void bound_bin(int axis, int b, std::uint32_t below_end, std::uint32_t above_end) {
    const AxisCosts& costs = costs_[axis];
    AxisBins& bins = bins_[axis];
    const std::uint32_t below = bins.n_below[b], n = static_cast<std::uint32_t>(refs_.size());
    if (histogram_.starts[axis][b] + histogram_.ends[axis][b] == 0) {
      bins.lower_bound[b] = INFINITY;
      return;
    }
    const double lo = std::clamp(maps_[axis].lower_edge(b), costs.lo(), costs.hi());
    const double hi = std::clamp(maps_[axis].upper_edge(b), costs.lo(), costs.hi());
    // What is neither surely below nor surely above goes at least to the smaller side.
    const std::uint32_t rest = n - std::min(n, below + above_end);
    const bool below_is_small = costs.area_below(lo) <= costs.area_above(hi);
    const LeafCost& tests = costs.tests();
    const double split_cost =
        costs.sum(costs.area_below(lo) * tests.at_least(below + (below_is_small ? rest : 0)) +
                  costs.area_above(hi) * tests.at_least(above_end + (below_is_small ? 0 : rest)));
    const bool may_be_empty = below == 0 || above_end == 0;
    bins.lower_bound[b] = split_cost * (may_be_empty ? std::min(1.0, costs.bonus()) : 1.0) * kSlack;
    // An upper bound needs a plane that surely cuts the cell, and one that surely is there.
    if (has_inner_plane(axis, b)) {
      const double most =
          costs.sum(costs.area_below(hi) * tests(below_end) + costs.area_above(lo) * tests(bins.n_above[b]));
      upper_bound_ = std::min(upper_bound_, most / kSlack);
    }
  }

  // Returns whether all positions of the bin lie inside the cell, none of them on its boundary.
  bool has_inner_plane(int axis, int b) const {
    const BinMap& map = maps_[axis];
    return map.n_bins > 1 && map.lower_edge(b) > costs_[axis].lo() && map.upper_edge(b) < costs_[axis].hi();
  }

  void collect_range(std::span<const BoundedRef> refs, int axis, std::vector<Event>& out) const {
    const BinMap map = maps_[axis];
    const bool* alive = bins_[axis].alive;
    for (const BoundedRef& r : refs) {
      const float lo = r.lo[axis], hi = r.hi[axis];
      if (lo == hi) {
        if (alive[map(lo)]) out.push_back(make_event(lo, EventKind::planar));
        continue;
      }
      if (alive[map(lo)]) out.push_back(make_event(lo, EventKind::start));
      if (alive[map(hi)]) out.push_back(make_event(hi, EventKind::end));
    }
  }

  void collect() {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<Event>& events = scratch_.events[axis];
      events.clear();
      const AxisBins& bins = bins_[axis];
      if (std::none_of(bins.alive, bins.alive + maps_[axis].n_bins, [](bool a) { return a; })) continue;
      if (!large()) {
        collect_range(refs_, axis, events);
        std::sort(events.begin(), events.end());
        continue;
      }
      std::vector<std::vector<Event>> parts(n_chunks(refs_.size()));
      for_chunks(refs_.size(), [&](std::size_t c, std::size_t first, std::size_t last) {
        collect_range(refs_.subspan(first, last - first), axis, parts[c]);
      });
      for (const std::vector<Event>& p : parts) events.insert(events.end(), p.begin(), p.end());
      tbb::parallel_sort(events.begin(), events.end());
    }
  }

  void sweep_axis(int axis, Split& best) const {
    const std::vector<Event>& events = scratch_.events[axis];
    std::size_t i = 0;
    while (i < events.size()) {
      const int bin = maps_[axis](position_of(events[i]));
      std::uint32_t n_below = bins_[axis].n_below[bin], n_above = bins_[axis].n_above[bin];
      // The events of a bin follow each other; the counts are known at its beginning.
      while (i < events.size()) {
        const float s = position_of(events[i]);
        if (maps_[axis](s) != bin) break;
        const Event next_position = make_event(s, EventKind::end) + 4;
        std::uint32_t count[3] = {};
        for (; i < events.size() && events[i] < next_position; ++i) ++count[events[i] & 3u];
        const std::uint32_t n_planar = count[1];
        n_above -= count[0] + n_planar;
        offer_plane(costs_[axis], axis, s, n_below, n_planar, n_above, best);
        n_below += count[2] + n_planar;
      }
    }
  }

  std::span<const BoundedRef> refs_;
  AxisCosts costs_[3];
  SweepScratch& scratch_;
  double upper_bound_;
  BinMap maps_[3];
  int n_bins_ = 1;
  Histogram histogram_;
  AxisBins bins_[3];
};

}  // namespace

Split sweep(std::span<const BoundedRef> refs, const Bounds& cell, const BuildConfig& config,
            SweepScratch& scratch) {
  return Sweep(refs, cell, config, scratch).run();
}

}  // namespace kdray::kdtree
