// What    The references of a cell that is swept (sweep-inl.h), in the order of their centres along each
//         axis.
// Shape   They are sorted once, by rank, and parting keeps the order. Numbers are relative to the longest
//         edge of the cell, and taken anew for a group that is hardly wider than their steps: they choose
//         where a group is parted and decide nothing else. Equal centres keep the references' order.
#if defined(KDRAY_BINNED_SWEPT_CELL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_SWEPT_CELL_INL_H
#undef KDRAY_BINNED_SWEPT_CELL_INL_H
#else
#define KDRAY_BINNED_SWEPT_CELL_INL_H
#endif

#include "accel/kdtree/binned/binned.h"
#include "accel/kdtree/binned/cost-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

// A place to part a group: behind the first n along an axis.
struct Part {
  std::size_t axis = 0, n = 0;
};

class SweptCell {
 public:
  using Axes = hn::Full128<float>;
  using P = hn::Vec<Axes>;

  explicit SweptCell(SweepBuffers& buffers) : buffers_(buffers) {}

  HWY_ATTR void load(std::span<const BoundedRef> refs, const Bounds& hull) {
    refs_ = refs.data();
    const Scale scale(hull);
    for (std::size_t i = 0; i < refs.size(); ++i) put(i, scale);
    for (std::size_t k = 0; k < 3; ++k) sort(refs.size(), k);
  }

  // Returns whether a group is so small a part of the cell that its numbers say little.
  bool is_coarse(std::size_t begin, std::size_t end) const {
    const std::array<int, 3> width = widths(begin, end);
    return std::max({width[0], width[1], width[2]}) < kCoarse;
  }

  // Returns how far apart a group's centres are along each axis.
  std::array<int, 3> widths(std::size_t begin, std::size_t end) const {
    std::array<int, 3> width;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& order = buffers_.order[k];
      width[k] = buffers_.center[k][order[end - 1]] - buffers_.center[k][order[begin]];
    }
    return width;
  }

  // Gives a group, whose order along all axes is known, numbers relative to its own size.
  HWY_ATTR void load_anew(std::size_t begin, std::size_t end) {
    Bounds hull = no_bounds();
    for (std::size_t i = begin; i < end; ++i) hull = kdtree::hull(hull, refs_[buffers_.order[0][i]].bounds());
    const Scale scale(hull);
    if (!scale.usable()) return;
    for (std::size_t i = begin; i < end; ++i) put(buffers_.order[0][i], scale);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& center = buffers_.center[k];
      std::stable_sort(buffers_.order[k].begin() + at(begin), buffers_.order[k].begin() + at(end),
                       [&](std::uint16_t a, std::uint16_t b) { return center[a] < center[b]; });
    }
  }

  // Moves what goes first to the front in the orders of the two other axes; along the part's own axis it is
  // there already.
  HWY_ATTR void keep_order(std::size_t begin, std::size_t end, const Part& part) {
    const std::uint16_t* const parted = buffers_.order[part.axis].data();
    std::uint8_t* const sides = buffers_.is_second.data();
    std::uint16_t* const others = buffers_.others.data();
    for (std::size_t i = begin; i < end; ++i) sides[parted[i]] = i < begin + part.n ? 0 : 1;
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == part.axis) continue;
      std::uint16_t *const order = buffers_.order[k].data(), *first = order + begin, *second = others;
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint16_t r = order[i];
        const std::ptrdiff_t is_second = sides[r];
        *first = r;
        *second = r;
        first += 1 - is_second;
        second += is_second;
      }
      std::copy(others, second, first);
    }
  }

  static std::ptrdiff_t at(std::size_t i) { return static_cast<std::ptrdiff_t>(i); }

  SweepBuffers& buffers_;
  const BoundedRef* refs_ = nullptr;

 private:
  static constexpr float kSteps = 16000;  // of twice a centre
  static constexpr int kCoarse = 64;

  // Numbers are relative to a hull's longest edge.
  struct Scale {
    std::array<float, 4> from;
    float of;

    explicit Scale(const Bounds& hull)
        : from{hull.lo[0], hull.lo[1], hull.lo[2], 0},
          of(1 / std::max({hull.hi[0] - hull.lo[0], hull.hi[1] - hull.lo[1], hull.hi[2] - hull.lo[2]})) {}
    bool usable() const { return of > 0 && of < std::numeric_limits<float>::max(); }
  };

  HWY_ATTR void put(std::size_t i, const Scale& scale) {
    const Axes d;
    const hn::RebindToSigned<Axes> di;
    const auto xyz = hn::FirstN(d, 3);  // the fourth lanes are a number and nothing
    const P from = hn::LoadU(d, scale.from.data()), of = hn::Set(d, scale.of);
    const P lo = hn::Mul(hn::IfThenElseZero(xyz, hn::Sub(hn::Load(d, refs_[i].lo.data()), from)), of);
    const P hi = hn::Mul(hn::IfThenElseZero(xyz, hn::Sub(hn::Load(d, refs_[i].hi.data()), from)), of);
    hn::Store(lo, d, buffers_.lo[i].data());
    hn::Store(hi, d, buffers_.hi[i].data());
    alignas(16) std::array<std::int32_t, 4> center;
    hn::Store(hn::ConvertTo(di, hn::Mul(hn::Add(lo, hi), hn::Set(d, kSteps))), di, center.data());
    for (std::size_t k = 0; k < 3; ++k) buffers_.center[k][i] = static_cast<std::int16_t>(center[k]);
  }

  // Puts each reference at the place of its rank. Those of the same centre have the same rank, and follow
  // each other.
  HWY_ATTR void sort(std::size_t n, std::size_t axis) {
    rank(n, buffers_.center[axis].data());
    std::fill_n(buffers_.ties.begin(), n, std::uint16_t{0});
    for (std::size_t i = 0; i < n; ++i) {
      const auto rank = static_cast<std::size_t>(buffers_.ranks[i]);
      buffers_.order[axis][rank + buffers_.ties[rank]++] = static_cast<std::uint16_t>(i);
    }
  }

  // Counts how many centres are below each, by the signs of differences: numbers have 15 bits.
  HWY_ATTR void rank(std::size_t n, const std::int16_t* centers) {
    const hn::CappedTag<std::int16_t, 2 * kMostLanes> d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t p = 0; p < n; p += lanes) {
      const auto here = hn::Load(d, centers + p);
      auto minus = hn::Zero(d);
      for (std::size_t i = 0; i < n; ++i)
        minus = hn::Add(minus, hn::ShiftRight<15>(hn::Sub(hn::Set(d, centers[i]), here)));
      hn::Store(hn::Neg(minus), d, buffers_.ranks.data() + p);
    }
  }
};

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
