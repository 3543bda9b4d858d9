// What    Divides what is in a cell further into groups, by primitives and not by a plane, so that each group
//         has tight bounds of its own.
// Why     Where primitives overlap, a plane cuts most of what it parts, and cells stay large: in heaps of
//         boxes a ray met three times the leaves and five times the triangles that it has to
//         (docs/logbook/kdtree.md).
// Shape   What is too large for a sweep (sweep-inl.h) is first parted at fifteen equal steps along each axis.
//         Costs are floats without contraction in a fixed order: the same bits at every vector width.
// Source  Stich, Friedrich, Dietrich, "Spatial splits in bounding volume hierarchies", HPG 2009: both kinds
//         of splits in one tree.
#if defined(KDRAY_BINNED_GROUP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_GROUP_INL_H
#undef KDRAY_BINNED_GROUP_INL_H
#else
#define KDRAY_BINNED_GROUP_INL_H
#endif

#include "accel/kdtree/binned/cost-inl.h"
#include "accel/kdtree/binned/divide-inl.h"
#include "accel/kdtree/binned/leaf-inl.h"
#include "accel/kdtree/binned/sweep-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

inline constexpr std::size_t kGroupBins = 16;
// Larger cells, which a budget or a depth has ended, stay whole except at the best quality: a million needles
// take three times as long to build.
inline constexpr std::size_t kMostGrouped = 2048;

// Where a group is parted: what has its doubled centre at `position` or below it goes first.
struct GroupSplit {
  int axis = -1;
  float position = 0;
  float cost = std::numeric_limits<float>::infinity();
};

// Returns twice the centre.
inline float center2(const BoundedRef& r, std::size_t k) {
  return r.lo[k] + r.hi[k];
}

// What groups cost, relative to their hull's surface; a hull without surface is measured by its length.
class GroupCosts {
 public:
  GroupCosts(const BuildConfig& config, const Bounds& hull)
      : traverse_(static_cast<float>(config.group_traverse)),
        tests_(config.block, 1 - static_cast<float>(config.group_each),
               std::max(1e-3f, static_cast<float>(config.group_each))) {
    const float longest =
        std::max({hull.hi[0] - hull.lo[0], hull.hi[1] - hull.lo[1], hull.hi[2] - hull.lo[2]});
    scale_ = 1 / longest;
    constexpr float kMax = std::numeric_limits<float>::max();
    usable_ = longest > 0 && longest < kMax && scale_ < kMax;
    if (usable_) inverse_size_ = 1 / size(hull);
  }

  bool usable() const { return usable_; }

  HWY_ATTR float leaf(std::size_t n) const { return tests_.of(n); }
  float scale() const { return scale_; }  // 1 / the longest edge

  HWY_ATTR V size(V x, V y, V z) const {
    const V s = hn::Set(Floats(), scale_);
    return size_of_scaled(hn::Mul(x, s), hn::Mul(y, s), hn::Mul(z, s));
  }
  HWY_ATTR V size_of_scaled(V a, V b, V c) const {
    const Floats d;
    const V area = hn::Add(hn::Add(hn::Mul(a, b), hn::Mul(b, c)), hn::Mul(c, a));
    return hn::Add(area, hn::Mul(hn::Add(hn::Add(a, b), c), hn::Set(d, kOfLength)));
  }
  HWY_ATTR V operator()(V size_first, V n_first, V size_second, V n_second) const {
    const Floats d;
    const V cost = hn::Add(hn::Mul(size_first, tests_(n_first)), hn::Mul(size_second, tests_(n_second)));
    return hn::Add(hn::Mul(cost, hn::Set(d, inverse_size_)), hn::Set(d, traverse_));
  }

 private:
  static constexpr float kOfLength = 1e-6f;

  HWY_ATTR float size(const Bounds& b) const {
    const Floats d;
    return hn::GetLane(
        size(hn::Set(d, b.hi[0] - b.lo[0]), hn::Set(d, b.hi[1] - b.lo[1]), hn::Set(d, b.hi[2] - b.lo[2])));
  }

  float traverse_;
  TestCost tests_;
  float scale_ = 1, inverse_size_ = 1;
  bool usable_;
};

// Offers the places between equal steps along an axis.
HWY_ATTR inline void offer_steps(std::span<const BoundedRef> refs, const GroupCosts& costs, std::size_t axis,
                                 GroupSplit& best) {
  float lo = std::numeric_limits<float>::infinity(), hi = -lo;
  for (const BoundedRef& r : refs) lo = std::min(lo, center2(r, axis)), hi = std::max(hi, center2(r, axis));
  const float step = (hi - lo) / kGroupBins;
  if (!(step > 0) || !(step < std::numeric_limits<float>::max())) return;
  std::array<float, kGroupBins - 1> positions;
  for (std::size_t b = 0; b + 1 < kGroupBins; ++b) positions[b] = lo + static_cast<float>(b + 1) * step;
  std::array<Bounds, kGroupBins> bins;
  std::array<std::size_t, kGroupBins> counts{};
  bins.fill(no_bounds());
  for (const BoundedRef& r : refs) {
    const float c = center2(r, axis);
    std::size_t b = 0;
    for (const float position : positions) b += c > position ? 1 : 0;
    bins[b] = hull(bins[b], r.bounds());
    ++counts[b];
  }
  std::array<Bounds, kGroupBins> second;
  second.back() = bins.back();
  for (std::size_t b = kGroupBins - 1; b-- > 0;) second[b] = hull(bins[b], second[b + 1]);
  Bounds first = no_bounds();
  std::size_t n = 0;
  const Floats d;
  for (std::size_t b = 0; b + 1 < kGroupBins; ++b) {
    first = hull(first, bins[b]);
    n += counts[b];
    if (n == 0 || n == refs.size()) continue;
    const auto length = [&](const Bounds& x, std::size_t k)
                            HWY_ATTR { return hn::Set(d, x.hi[k] - x.lo[k]); };
    const auto size = [&](const Bounds& x)
                          HWY_ATTR { return costs.size(length(x, 0), length(x, 1), length(x, 2)); };
    const float cost = hn::GetLane(costs(size(first), hn::Set(d, static_cast<float>(n)), size(second[b + 1]),
                                         hn::Set(d, static_cast<float>(refs.size() - n))));
    if (cost < best.cost) best = {static_cast<int>(axis), positions[b], cost};
  }
}

HWY_ATTR inline GroupSplit best_between_steps(std::span<const BoundedRef> refs, const GroupCosts& costs) {
  GroupSplit best;
  for (std::size_t axis = 0; axis < 3; ++axis) offer_steps(refs, costs, axis, best);
  return best;
}

// Appends a cell's references to the fragment: as a leaf, or as groups of them.
class Grouper {
 public:
  Grouper(const BuildConfig& config, int depth, std::vector<BoundedRef>& scratch, SweepBuffers& sweep,
          Fragment& out)
      : config_(config), depth_(depth), scratch_(scratch), sweep_(sweep), out_(out) {}

  // Appends the references and leaves them in another order. Returns `contents`, their hull.
  HWY_ATTR Box append(std::span<BoundedRef> refs, const Bounds& contents, int level = 0) {
    const GroupCosts costs(config_, contents);
    if (stays_whole(refs.size()) || !costs.usable() || level == kMostGroupLevels)
      return append_ranked_leaf(refs, contents, depth_, out_);
    if (refs.size() <= kSwept) {
      Sweep(config_, depth_, sweep_, out_).append(refs, contents, level);
      return box_from(contents);
    }
    const std::size_t n = part_large(refs, costs);
    if (n == 0) return append_ranked_leaf(refs, contents, depth_, out_);
    const std::size_t node = out_.nodes.size();
    out_.nodes.emplace_back();
    out_.contents.push_back(box_from(contents));
    const int axis = axis_;
    const std::span<BoundedRef> first = refs.first(n), second = refs.subspan(n);
    append(first, hull_of_refs(first), level + 1);
    out_.nodes[node] = {Node::kGroups + static_cast<std::uint32_t>(axis), 0,
                        static_cast<std::uint32_t>(node + 1), static_cast<std::uint32_t>(out_.nodes.size())};
    append(second, hull_of_refs(second), level + 1);
    return out_.contents[node];
  }

 private:
  // Where tests are counted by blocks, less than a block isn't worth dividing.
  bool stays_whole(std::size_t n) const {
    if (n > kMostGrouped && config_.quality != Quality::best) return true;
    return n <= (config_.group_each > 0 ? 1 : static_cast<std::size_t>(config_.block));
  }

  // Orders the references and returns how many of them go first; 0 where all stay together.
  HWY_ATTR std::size_t part_large(std::span<BoundedRef> refs, const GroupCosts& costs) {
    const GroupSplit split = best_between_steps(refs, costs);
    if (!(split.cost < costs.leaf(refs.size()))) return 0;
    axis_ = split.axis;
    const auto k = static_cast<std::size_t>(split.axis);
    return part(refs, [&](std::size_t i) { return center2(refs[i], k) <= split.position; });
  }

  // Parts the references and keeps the order on both sides. Calls is_first for a reference before its place
  // is written.
  template <class IsFirst>
  std::size_t part(std::span<BoundedRef> refs, const IsFirst& is_first) {
    if (scratch_.size() < refs.size() + 1) scratch_.resize(refs.size() + 1);
    std::size_t n_first = 0, n_second = 0;
    for (std::size_t i = 0; i < refs.size(); ++i) {
      const bool first = is_first(i);
      const BoundedRef r = refs[i];
      scratch_[n_second] = r;
      refs[n_first] = r;
      n_first += first ? 1 : 0;
      n_second += first ? 0 : 1;
    }
    std::copy_n(scratch_.begin(), n_second, refs.begin() + static_cast<std::ptrdiff_t>(n_first));
    return n_first;
  }

  const BuildConfig& config_;
  const int depth_;
  int axis_ = 0;  // of the last that was parted
  std::vector<BoundedRef>& scratch_;
  SweepBuffers& sweep_;
  Fragment& out_;
};

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
