// What    Finds the groups of a cell of up to kSwept references: at every node it tries all places to part
//         it, along all axes that are not narrow.
// Why     In the order of centres (swept_cell-inl.h) the hulls of the first i and of the others come from one
//         pass in each direction, and lanes are places: n steps a node instead of n for each place.
// Shape   Costs are floats without contraction; the place is packed into the lowest bits of its cost, so that
//         the cheapest one is a minimum of integers, whatever the vectors' width, and ties go to the smaller
//         axis and place.
// Source  Wald, "On fast construction of SAH-based bounding volume hierarchies", RT 2007.
#if defined(KDRAY_BINNED_SWEEP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_SWEEP_INL_H
#undef KDRAY_BINNED_SWEEP_INL_H
#else
#define KDRAY_BINNED_SWEEP_INL_H
#endif

#include <bit>
#include <cstdlib>

#include "accel/kdtree/binned/cost-inl.h"
#include "accel/kdtree/binned/leaf-inl.h"
#include "accel/kdtree/binned/swept_cell-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

inline constexpr int kMostGroupLevels = 64;
inline constexpr std::size_t kFewPlaces = 17;  // up to here vectors of four do
inline constexpr std::size_t kPairs = 3;       // and up to here all parts are tried, in no order

class Sweep : private SweptCell {
 public:
  Sweep(const BuildConfig& config, int depth, SweepBuffers& buffers, Fragment& out)
      : SweptCell(buffers),
        config_(config),
        depth_(depth),
        traverse_(static_cast<float>(config.group_traverse)),
        tests_(config.block, 1 - static_cast<float>(config.group_each),
               std::max(1e-3f, static_cast<float>(config.group_each))),
        out_(out) {}

  // Appends 1 to kSwept references, with their hull.
  HWY_ATTR void append(std::span<const BoundedRef> refs, const Bounds& hull, int level) {
    first_node_ = static_cast<std::uint32_t>(out_.nodes.size());
    first_ref_ = static_cast<std::uint32_t>(out_.refs.size());
    buffers_.n_nodes = buffers_.n_refs = 0;
    load(refs, hull);
    fill_tests(refs.size());
    build(0, refs.size(), 0, level);
    out_.nodes.insert(out_.nodes.end(), buffers_.nodes.begin(),
                      buffers_.nodes.begin() + at(buffers_.n_nodes));
    out_.contents.insert(out_.contents.end(), buffers_.contents.begin(),
                         buffers_.contents.begin() + at(buffers_.n_nodes));
    out_.refs.insert(out_.refs.end(), buffers_.refs.begin(), buffers_.refs.begin() + at(buffers_.n_refs));
    out_.max_depth = std::max(out_.max_depth, depth_);
  }

 private:
  static constexpr float kOfLength = 1e-6f;               // a hull without surface is measured by its length
  static constexpr int kPlaceBits = 12, kAxisShift = 10;  // of a cost's bits: two for the axis
  static_assert(kSwept < std::size_t{1} << kAxisShift);

  HWY_ATTR void fill_tests(std::size_t n) {
    const Floats d;
    for (std::size_t i = 0; i <= n; i += hn::Lanes(d)) {
      const V first = hn::Iota(d, static_cast<float>(i));
      hn::StoreU(tests_(first), d, buffers_.tests.data() + i);
      const V second = hn::Max(hn::Sub(hn::Set(d, static_cast<float>(n)), first), hn::Zero(d));
      hn::StoreU(tests_(second), d, buffers_.tests_backward.data() + (kSwept - n) + i);
    }
  }

  // ---- Nodes

  // Builds the subtree of the references at [begin, end) in the order along that axis, or along every axis
  // where they are more than two. Returns their hull.
  HWY_ATTR Box build(std::size_t begin, std::size_t end, std::size_t axis, int level) {
    const std::size_t n = end - begin;
    if (n <= most_whole() || level == kMostGroupLevels) return append_leaf(begin, n, axis);
    if (n > most_unsorted() && is_coarse(begin, end)) load_anew(begin, end);
    const Part part = best_part(begin, n, axis);
    if (part.n == 0) return append_leaf(begin, n, axis);
    if (n - part.n > most_unsorted() || part.n > most_unsorted()) keep_order(begin, end, part);
    const std::size_t node = buffers_.n_nodes++, middle = begin + part.n;
    Box hull = build(begin, middle, part.axis, level + 1);
    const std::uint32_t second = first_node_ + static_cast<std::uint32_t>(buffers_.n_nodes);
    hull.grow(build(middle, end, part.axis, level + 1));
    buffers_.nodes[node] = {Node::kGroups + static_cast<std::uint32_t>(part.axis), 0,
                            first_node_ + static_cast<std::uint32_t>(node) + 1, second};
    buffers_.contents[node] = hull;
    return hull;
  }

  // Where tests are counted by blocks, less than a block isn't worth parting.
  std::size_t most_whole() const {
    return config_.group_each > 0 ? 1 : static_cast<std::size_t>(config_.block);
  }
  std::size_t most_unsorted() const { return std::max(most_whole(), kPairs); }

  HWY_ATTR Box append_leaf(std::size_t begin, std::size_t n, std::size_t axis) {
    const std::uint16_t* const order = buffers_.order[axis].data() + begin;
    const std::size_t node = buffers_.n_nodes++, ref = buffers_.n_refs;
    buffers_.n_refs += n;
    const Axes d;
    P lo = hn::Inf(d), hi = hn::Neg(lo);
    alignas(64) std::array<Ref, kSwept> values;
    for (std::size_t i = 0; i < n; ++i) {
      const BoundedRef& r = refs_[order[i]];
      lo = hn::Min(lo, hn::Load(d, r.lo.data()));
      hi = hn::Max(hi, hn::Load(d, r.hi.data()));
      values[i] = r.ref;
    }
    Ref* const refs = buffers_.refs.data() + ref;
    if (n <= kMostRanked) {
      write_ascending(values.data(), n, refs);
    } else {
      std::copy_n(values.data(), n, refs);
      std::sort(refs, refs + n);
    }
    buffers_.nodes[node] = {Node::kLeaf, 0, first_ref_ + static_cast<std::uint32_t>(ref),
                            static_cast<std::uint32_t>(n)};
    alignas(16) std::array<float, 4> l, h;
    hn::Store(lo, d, l.data());
    hn::Store(hi, d, h.data());
    return buffers_.contents[node] = {{l[0], l[1], l[2]}, {h[0], h[1], h[2]}};
  }

  // Returns the best place, where it is cheaper than a leaf; else one where nothing goes first.
  HWY_ATTR Part best_part(std::size_t begin, std::size_t n, std::size_t axis) {
    if (n <= kPairs) return part_of_few(begin, n, axis);
    return n <= kFewPlaces ? best_part_of(Axes(), begin, n) : best_part_of(Floats(), begin, n);
  }

  struct Hull {
    P lo, hi;
    HWY_ATTR Hull with(const Hull& other) const { return {hn::Min(lo, other.lo), hn::Max(hi, other.hi)}; }
  };
  HWY_ATTR Hull hull_of(std::size_t i) const {
    const Axes d;
    return {hn::Load(d, buffers_.lo[i].data()), hn::Load(d, buffers_.hi[i].data())};
  }
  HWY_ATTR static float size_of(const Hull& hull) {
    const Axes d;
    alignas(16) std::array<float, 4> e;
    hn::Store(hn::Sub(hull.hi, hull.lo), d, e.data());
    return e[0] * (e[1] + kOfLength) + e[1] * (e[2] + kOfLength) + e[2] * (e[0] + kOfLength);
  }

  // Any of two or three may be alone, whatever the axis. So the axis is the one along which the two sides are
  // farthest apart, which only sets their order.
  HWY_ATTR Part part_of_few(std::size_t begin, std::size_t n, std::size_t axis) {
    std::array<std::uint16_t, 3> refs;  // the one that is alone first
    std::copy_n(buffers_.order[axis].data() + begin, n, refs.begin());
    const Hull a = hull_of(refs[0]), b = hull_of(refs[1]);
    Hull one = a, others = b;
    float cost = (size_of(a) + (n == 2 ? size_of(b) : 0)) * buffers_.tests[1];
    if (n == 3) {
      const Hull c = hull_of(refs[2]);
      others = b.with(c);
      const Hull ac = a.with(c), ab = a.with(b);
      const float tests = buffers_.tests[1], pair = buffers_.tests[2];
      cost += size_of(others) * pair;
      const float cost_b = size_of(b) * tests + size_of(ac) * pair;
      const float cost_c = size_of(c) * tests + size_of(ab) * pair;
      if (cost_b < cost && !(cost_c < cost_b)) {
        one = b, others = ac, cost = cost_b;
        std::swap(refs[0], refs[1]);
      } else if (cost_c < cost) {
        one = c, others = ab, cost = cost_c;
        std::swap(refs[0], refs[2]);
      }
    }
    if (!is_cheaper(cost, size_of(one.with(others)), n)) return {};
    return put_apart(begin, n, refs, one, others);
  }

  HWY_ATTR Part put_apart(std::size_t begin, std::size_t n, std::array<std::uint16_t, 3> refs,
                          const Hull& one, const Hull& others) {
    const Axes d;
    alignas(16) std::array<float, 4> apart;  // twice the centres
    hn::Store(hn::Sub(hn::Add(others.lo, others.hi), hn::Add(one.lo, one.hi)), d, apart.data());
    std::size_t axis = std::abs(apart[1]) > std::abs(apart[0]) ? 1 : 0;
    if (std::abs(apart[2]) > std::abs(apart[axis])) axis = 2;
    const bool one_first = apart[axis] >= 0;
    if (!one_first) std::rotate(refs.begin(), refs.begin() + 1, refs.begin() + at(n));
    std::copy_n(refs.begin(), n, buffers_.order[axis].data() + begin);
    return {axis, one_first ? 1 : n - 1};
  }

  template <class D>
  HWY_ATTR Part best_part_of(D d, std::size_t begin, std::size_t n) {
    const hn::RebindToSigned<D> di;
    const auto end = hn::Set(di, static_cast<std::int32_t>(n));
    const std::array<int, 3> width = widths(begin, begin + n);
    const int widest = std::max({width[0], width[1], width[2]});
    const auto cost_bits = hn::Set(di, -(1 << kPlaceBits));
    auto best = hn::Set(di, std::numeric_limits<std::int32_t>::max());
    if (widest == 0) return {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (2 * width[axis] < widest) continue;  // what is narrow is seldom best parted across
      measure_hulls(buffers_.order[axis].data() + begin, n);
      const auto axis_bits = hn::Set(di, static_cast<std::int32_t>(axis << kAxisShift));
      for (std::size_t p = 1; p < n; p += hn::Lanes(d)) {
        const auto first = hn::Mul(size_of(d, buffers_.first, p), hn::LoadU(d, &buffers_.tests[p]));
        const auto second =
            hn::Mul(size_of(d, buffers_.second, p), hn::LoadU(d, &buffers_.tests_backward[kSwept - n + p]));
        const auto cost = hn::And(hn::BitCast(di, hn::Add(first, second)), cost_bits);
        const auto place = hn::Iota(di, static_cast<std::int32_t>(p));
        const auto packed = hn::Or(cost, hn::Or(place, axis_bits));
        best = hn::IfThenElse(hn::Lt(place, end), hn::Min(best, packed), best);
      }
    }
    const auto least = static_cast<std::uint32_t>(hn::GetLane(hn::MinOfLanes(di, best)));
    const float cost = std::bit_cast<float>(least & ~((1u << kPlaceBits) - 1));
    if (!is_cheaper(cost, hn::GetLane(size_of(d, buffers_.first, n)), n)) return {};
    return {least >> kAxisShift & 3u, least & ((1u << kAxisShift) - 1)};
  }

  bool is_cheaper(float tests, float whole, std::size_t n) const {
    return traverse_ * whole + tests < buffers_.tests[n] * whole;
  }

  // Measures the hulls of n references, in that order, along the axes: those of the first i in `first`, those
  // of the others in `second`.
  HWY_ATTR void measure_hulls(const std::uint16_t* order, std::size_t n) {
    const Axes d;
    const P inf = hn::Inf(d);
    P first_lo = inf, second_lo = inf, first_hi = hn::Neg(inf), second_hi = first_hi;
    const SweepBuffers::Corner *const lo = buffers_.lo.data(), *const hi = buffers_.hi.data();
    SweepBuffers::Corner *const first = buffers_.first.data() + 1, *const second = buffers_.second.data();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t j = n - 1 - i, f = order[i], s = order[j];
      first_lo = hn::Min(first_lo, hn::Load(d, lo[f].data()));
      first_hi = hn::Max(first_hi, hn::Load(d, hi[f].data()));
      hn::Store(hn::Sub(first_hi, first_lo), d, first[i].data());
      second_lo = hn::Min(second_lo, hn::Load(d, lo[s].data()));
      second_hi = hn::Max(second_hi, hn::Load(d, hi[s].data()));
      hn::Store(hn::Sub(second_hi, second_lo), d, second[j].data());
    }
  }

  // Returns half the surfaces of the hulls at [i, i + lanes).
  template <class D>
  HWY_ATTR static hn::Vec<D> size_of(D d, const SweepBuffers::Edges& edges, std::size_t i) {
    hn::Vec<D> x, y, z, nothing;
    hn::LoadInterleaved4(d, edges[i].data(), x, y, z, nothing);
    const auto c = hn::Set(d, kOfLength);
    const auto xy = hn::Mul(x, hn::Add(y, c)), yz = hn::Mul(y, hn::Add(z, c)), zx = hn::Mul(z, hn::Add(x, c));
    return hn::Add(hn::Add(xy, yz), zx);
  }

  const BuildConfig& config_;
  const int depth_;
  const float traverse_;
  const TestCost tests_;
  Fragment& out_;
  std::uint32_t first_node_ = 0, first_ref_ = 0;  // of the cell in the fragment
};

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
