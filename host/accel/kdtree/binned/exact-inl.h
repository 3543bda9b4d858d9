// What    Exact costs of planes at the references' own bounds: of all of them in small cells, and of those
//         near the best bin's plane in larger ones.
// Shape   Lanes are planes; every lane runs over the references. Nothing is sorted: for the few dozens here
//         that would be slower.
#if defined(KDRAY_BINNED_EXACT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_EXACT_INL_H
#undef KDRAY_BINNED_EXACT_INL_H
#else
#define KDRAY_BINNED_EXACT_INL_H
#endif

#include "accel/kdtree/binned/binned.h"
#include "accel/kdtree/binned/cost-inl.h"
#include "base/box.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

// Cells with more references than this keep a plane between two bins: the exact place matters less there.
inline constexpr std::size_t kRefined = 512;

// References along one axis: the bounds that are to be compared with planes, and the planes to try.
struct Candidates {
  alignas(64) std::array<float, kRefined> begins;
  alignas(64) std::array<float, kRefined> ends;
  // Planes come in pairs of vectors; what is behind the last is not inside the cell.
  alignas(64) std::array<float, 2 * kRefined + 2 * kMostLanes> planes;
  std::size_t n_begins = 0, n_ends = 0, n_planes = 0;
  std::size_t base_below = 0, base_above = 0;  // references on a side of all planes

  void pad_planes(float outside) {
    std::fill_n(planes.begin() + static_cast<std::ptrdiff_t>(n_planes), 2 * kMostLanes, outside);
  }
};

// A reference is below a plane when it begins before it or lies in it, and above when it ends behind it: one
// that lies in a plane begins, for this purpose, a step before it.
inline float begin_of(float lo, float hi) {
  return lo == hi ? next_below(lo) : lo;
}

HWY_ATTR inline void offer_planes(const Candidates& c, const PlaneCosts& costs, int axis, Best& best) {
  const Floats d;
  const Ints di;
  const std::size_t n_lanes = hn::Lanes(d);
  const VI one = hn::Set(di, 1);
  const auto base_below = static_cast<std::int32_t>(c.base_below),
             base_above = static_cast<std::int32_t>(c.base_above);
  BestOfAxis best_here;
  for (std::size_t p = 0; p < c.n_planes; p += 2 * n_lanes) {
    const V plane0 = hn::Load(d, &c.planes[p]), plane1 = hn::Load(d, &c.planes[p + n_lanes]);
    VI below0 = hn::Set(di, base_below), below1 = below0, above0 = hn::Set(di, base_above), above1 = above0;
    for (std::size_t i = 0; i < c.n_begins; ++i) {
      const V begin = hn::Set(d, c.begins[i]);
      below0 = hn::IfThenElse(hn::RebindMask(di, hn::Lt(begin, plane0)), hn::Add(below0, one), below0);
      below1 = hn::IfThenElse(hn::RebindMask(di, hn::Lt(begin, plane1)), hn::Add(below1, one), below1);
    }
    for (std::size_t i = 0; i < c.n_ends; ++i) {
      const V end = hn::Set(d, c.ends[i]);
      above0 = hn::IfThenElse(hn::RebindMask(di, hn::Lt(plane0, end)), hn::Add(above0, one), above0);
      above1 = hn::IfThenElse(hn::RebindMask(di, hn::Lt(plane1, end)), hn::Add(above1, one), above1);
    }
    best_here.offer(costs(plane0, hn::ConvertTo(d, below0), hn::ConvertTo(d, above0)), plane0);
    best_here.offer(costs(plane1, hn::ConvertTo(d, below1), hn::ConvertTo(d, above1)), plane1);
  }
  best_here.offer_to(best, axis);
}

// Returns the best of all planes of a small cell.
inline constexpr std::size_t kSmallCell = 48;

// Bounds of the references by axis, begins at even places and ends at odd ones: planes as they are.
struct BoundsByAxis {
  alignas(64) std::array<std::array<float, 2 * kSmallCell + 2 * kMostLanes>, 3> bounds;
};

// Reads one reference more than there are when their number is odd.
HWY_ATTR inline void transpose(std::span<const BoundedRef> refs, BoundsByAxis& out) {
  const hn::Full128<float> d;
  hn::Vec<hn::Full128<float>> x, y, z, number;
  for (std::size_t i = 0; i < refs.size(); i += 2) {
    hn::LoadInterleaved4(d, refs[i].lo.data(), x, y, z, number);
    hn::Store(x, d, &out.bounds[0][2 * i]);
    hn::Store(y, d, &out.bounds[1][2 * i]);
    hn::Store(z, d, &out.bounds[2][2 * i]);
  }
}

// Counting compares two 16-bit numbers in each lane: a plane's rank with the rank where a reference begins,
// and the negative of both where it ends.
using Shorts = hn::Repartition<std::int16_t, Floats>;
using VS = hn::Vec<Shorts>;

HWY_ATTR inline VI pair_of(VI low, VI high) {
  return hn::Or(hn::And(low, hn::Set(Ints(), 0xffff)), hn::ShiftLeft<16>(high));
}

// Ranks are in the order of bounds, except where bounds differ by less than 1/32000 of the cell: as with
// bins, such counts choose a plane and decide nothing else. What lies in a plane begins, for this purpose, a
// step before it.
struct Ranks {
  alignas(64) std::array<std::int32_t, 2 * kSmallCell + 2 * kMostLanes> planes;
  alignas(
      64) std::array<std::int32_t, 2 * kSmallCell + 2 * kMostLanes> refs;  // of each the first of two places

  HWY_ATTR Ranks(const float* bounds, std::size_t n, const PlaneCosts& costs) {
    const Floats d;
    const Ints di;
    // The scale is limited for a cell of hardly any width.
    const float scale = std::min(32000 / (costs.hi() - costs.lo()), std::numeric_limits<float>::max());
    for (std::size_t p = 0; p < 2 * n; p += hn::Lanes(d)) {
      const V bound = hn::Load(d, bounds + p);
      const VI rank = hn::ConvertTo(di, hn::Mul(hn::Sub(bound, hn::Set(d, costs.lo())), hn::Set(d, scale)));
      const VI minus = hn::Neg(rank);
      const auto planar = hn::RebindMask(di, hn::Eq(bound, hn::Shuffle2301(bound)));
      const VI begin = hn::Sub(rank, hn::IfThenElseZero(planar, hn::Set(di, 1)));
      hn::Store(pair_of(rank, minus), di, &planes[p]);
      hn::Store(pair_of(begin, hn::Shuffle2301(minus)), di, &refs[p]);
    }
  }
};

// Counts of references on both sides of a vector of planes.
struct SidesOfPlanes {
  VS counts;

  HWY_ATTR void add(VS plane, VS ref) {
    counts = hn::IfThenElse(hn::Lt(ref, plane), hn::Add(counts, hn::Set(Shorts(), 1)), counts);
  }
  HWY_ATTR void offer_to(BestOfAxis& best, const PlaneCosts& costs, const float* planes) const {
    const Floats d;
    const Ints di;
    const VI pairs = hn::BitCast(di, counts);
    const V below = hn::ConvertTo(d, hn::And(pairs, hn::Set(di, 0xffff)));
    const V above = hn::ConvertTo(d, hn::ShiftRight<16>(pairs));
    const V plane = hn::Load(d, planes);
    best.offer(costs(plane, below, above), plane);
  }
};

HWY_ATTR inline void offer_bounds(const float* bounds, std::size_t n, const PlaneCosts& costs, int axis,
                                  Best& best) {
  const Ints di;
  const Shorts d16;
  const std::size_t n_lanes = hn::Lanes(di);
  const Ranks ranks(bounds, n, costs);
  BestOfAxis best_here;
  for (std::size_t p = 0; p < 2 * n; p += 2 * n_lanes) {
    const VS plane0 = hn::BitCast(d16, hn::Load(di, &ranks.planes[p]));
    const VS plane1 = hn::BitCast(d16, hn::Load(di, &ranks.planes[p + n_lanes]));
    SidesOfPlanes sides0{hn::Zero(d16)}, sides1 = sides0;
    for (std::size_t i = 0; i < n; ++i) {
      const VS ref = hn::BitCast(d16, hn::Set(di, ranks.refs[2 * i]));
      sides0.add(plane0, ref);
      sides1.add(plane1, ref);
    }
    sides0.offer_to(best_here, costs, bounds + p);
    sides1.offer_to(best_here, costs, bounds + p + n_lanes);
  }
  best_here.offer_to(best, axis);
}

HWY_ATTR inline Best best_of_all(std::span<const BoundedRef> refs, const Bounds& contents,
                                 const BuildConfig& config) {
  Best best;
  BoundsByAxis by_axis;
  transpose(refs, by_axis);
  for (const int axis : longest_first(contents)) {
    const PlaneCosts costs(config, contents, axis);
    if (!costs.usable() || !costs.may_beat(best.cost, refs.size())) continue;
    auto& bounds = by_axis.bounds[static_cast<std::size_t>(axis)];
    // The lanes behind the last bound get planes that are not inside.
    std::fill_n(bounds.begin() + static_cast<std::ptrdiff_t>(2 * refs.size()), 2 * kMostLanes, costs.lo());
    offer_bounds(bounds.data(), refs.size(), costs, axis, best);
  }
  return best;
}

// Tries the bounds in the two bins beside the best plane exactly, for a cell of at most kRefined references.
HWY_ATTR inline void refine(std::span<const BoundedRef> refs, const Bounds& contents, const BinGrid& grid,
                            const BuildConfig& config, Best& best) {
  const int axis = best.plane.axis;
  const auto k = static_cast<std::size_t>(axis);
  const PlaneCosts costs(config, contents, axis);
  const float bin = (grid.hi[k] - grid.lo[k]) / kBins;
  const float from = std::max(best.plane.position - bin, costs.lo()),
              to = std::min(best.plane.position + bin, costs.hi());
  Candidates c;
  std::size_t n_begins = 0, n_ends = 0, n_planes = 0, below = 0, above = 0;
  for (const BoundedRef& r : refs) {
    const float lo = r.lo[k], hi = r.hi[k];
    const int begins = static_cast<int>(lo > from) & static_cast<int>(lo < to);
    const int ends = static_cast<int>(hi > from) & static_cast<int>(hi < to);
    c.begins[n_begins] = begin_of(lo, hi);
    n_begins += static_cast<std::size_t>(begins);
    c.planes[n_planes] = lo;
    n_planes += static_cast<std::size_t>(begins);
    c.ends[n_ends] = hi;
    n_ends += static_cast<std::size_t>(ends);
    c.planes[n_planes] = hi;
    n_planes += static_cast<std::size_t>(ends);
    below += lo <= from ? 1 : 0;
    above += hi >= to ? 1 : 0;
  }
  c.n_begins = n_begins;
  c.n_ends = n_ends;
  c.n_planes = n_planes;
  c.base_below = below;
  c.base_above = above;
  c.pad_planes(costs.lo());
  Best exact;
  offer_planes(c, costs, axis, exact);
  if (exact.cost < best.cost) best = exact;
}

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
