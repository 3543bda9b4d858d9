// What    Counts references into bins, and finds the best plane between two bins.
#if defined(KDRAY_BINNED_BINS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_BINS_INL_H
#undef KDRAY_BINNED_BINS_INL_H
#else
#define KDRAY_BINNED_BINS_INL_H
#endif

#include "accel/kdtree/binned/binned.h"
#include "accel/kdtree/binned/cost-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

// The bins in which a reference begins and ends, counted from the two sides.
struct BinPair {
  alignas(16) std::int32_t begin[4], end[4];
};

// Returns the floors of x, clamped to the bins. Between 32 and 64 the first five bits behind a float's
// leading one are the floor of what it exceeds 32 by: cheaper than a conversion.
HWY_ATTR inline hn::Vec<hn::Full128<std::int32_t>> bin_of(hn::Vec<hn::Full128<float>> x) {
  static_assert(kBins == 32);
  const hn::Full128<float> d;
  const hn::Full128<std::int32_t> di;
  const auto clamped = hn::Min(hn::Max(x, hn::Zero(d)), hn::Set(d, static_cast<float>(kBins - 1)));
  const auto bits = hn::BitCast(di, hn::Add(clamped, hn::Set(d, static_cast<float>(kBins))));
  return hn::And(hn::ShiftRight<18>(bits), hn::Set(di, kBins - 1));
}

HWY_ATTR inline void find_bins(const BoundedRef& r, const BinGrid& grid, BinPair& bins) {
  const hn::Full128<float> d;
  const hn::Full128<std::int32_t> di;
  const auto scale = hn::Load(d, grid.scale.data());
  const auto begin = hn::Mul(hn::Sub(hn::Load(d, r.lo.data()), hn::Load(d, grid.lo.data())), scale);
  const auto end = hn::Mul(hn::Sub(hn::Load(d, grid.hi.data()), hn::Load(d, r.hi.data())), scale);
  hn::Store(bin_of(begin), di, bins.begin);
  hn::Store(bin_of(end), di, bins.end);
}

HWY_ATTR inline void add_bins(const BinPair& bins, BinCounts& counts) {
  for (std::size_t k = 0; k < 3; ++k) {
    ++counts.begins[k][static_cast<std::size_t>(bins.begin[k])];
    ++counts.ends[k][static_cast<std::size_t>(bins.end[k])];
  }
}

// Does the same as BinCounts::add, in the widest vectors: a small cell has fewer references than bins.
HWY_ATTR inline void add_counts(const BinCounts& from, BinCounts& to) {
  const hn::CappedTag<std::uint32_t, 16> d;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t b = 0; b < kBins; b += hn::Lanes(d)) {
      const auto add = [&](const auto& more, auto& sum) HWY_ATTR {
        hn::Store(hn::Add(hn::Load(d, &more[k][b]), hn::Load(d, &sum[k][b])), d, &sum[k][b]);
      };
      add(from.begins, to.begins);
      add(from.ends, to.ends);
    }
}

// Adds to two sets of counts in turn: neighbours often fall into one bin, and a count that was just written
// is slow to be read again.
HWY_ATTR inline void count_bins(std::span<const BoundedRef> refs, const BinGrid& grid, std::size_t stride,
                                BinCounts& counts) {
  BinCounts odd;
  BinPair first, second;
  std::size_t i = 0;
  for (; i + stride < refs.size(); i += 2 * stride) {
    find_bins(refs[i], grid, first);
    find_bins(refs[i + stride], grid, second);
    add_bins(first, counts);
    add_bins(second, odd);
  }
  if (i < refs.size()) {
    find_bins(refs[i], grid, first);
    add_bins(first, counts);
  }
  add_counts(odd, counts);
}

// References below and above the plane in front of each bin.
struct SideCounts {
  alignas(64) std::array<std::int32_t, kBins> below, above;
};

inline SideCounts side_counts(const BinCounts& counts, std::size_t axis) {
  SideCounts sides;
  std::int32_t below = 0, above = 0;
  sides.below[0] = sides.above[0] = 0;
  for (std::size_t b = 1; b < kBins; ++b) {
    below += static_cast<std::int32_t>(counts.begins[axis][b - 1]);
    above += static_cast<std::int32_t>(counts.ends[axis][b - 1]);
    sides.below[b] = below;
    sides.above[kBins - b] = above;
  }
  return sides;
}

// Returns the best of the planes between bins, for a cell of n references.
HWY_ATTR inline Best best_between_bins(const BinCounts& counts, const BinGrid& grid, const Bounds& contents,
                                       std::size_t n, const BuildConfig& config) {
  const Floats d;
  const Ints di;
  const V stride = hn::Set(d, static_cast<float>(sample_stride(n)));
  Best best;
  for (const int axis : longest_first(contents)) {
    const auto k = static_cast<std::size_t>(axis);
    const PlaneCosts costs(config, contents, axis);
    if (!costs.usable() || grid.scale[k] == 0 || !costs.may_beat(best.cost, n)) continue;
    const SideCounts sides = side_counts(counts, k);
    BestOfAxis best_here;
    for (std::size_t b = 0; b < kBins; b += hn::Lanes(d)) {
      // The planes lie where BinGrid::plane has them. The one in front of the first bin is not inside.
      const V share = hn::Mul(hn::Iota(d, static_cast<float>(b)), hn::Set(d, 1.0f / kBins));
      const V plane = hn::Add(hn::Set(d, grid.lo[k]), hn::Mul(hn::Set(d, grid.hi[k] - grid.lo[k]), share));
      const V below = hn::Mul(hn::ConvertTo(d, hn::Load(di, &sides.below[b])), stride);
      const V above = hn::Mul(hn::ConvertTo(d, hn::Load(di, &sides.above[b])), stride);
      best_here.offer(costs(plane, below, above), plane);
    }
    best_here.offer_to(best, axis);
  }
  return best;
}

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
