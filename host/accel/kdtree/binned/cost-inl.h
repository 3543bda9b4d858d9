// What    The expected costs of planes across one axis of a cell, as many at once as a vector has lanes: the
//         cost model of kdtree/sah.h (LeafCost and AxisCosts) in float. Both have to be changed together.
// Shape   Costs are floats without contraction: the same bits on every instruction set. Lengths are taken
//         relative to the cell's longest, so that neither tiny nor huge scenes leave the range of floats.
#if defined(KDRAY_BINNED_COST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_COST_INL_H
#undef KDRAY_BINNED_COST_INL_H
#else
#define KDRAY_BINNED_COST_INL_H
#endif

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "accel/kdtree/build.h"
#include "accel/kdtree/reference.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using V = hn::Vec<Floats>;
using VI = hn::Vec<Ints>;
inline constexpr std::size_t kMostLanes = 16;

// LeafCost (kdtree/sah.h) in floats.
class TestCost {
 public:
  explicit TestCost(int block) : TestCost(block, 1, block > 1 ? 1e-3f : 0.0f) {}

  // A leaf costs `whole` for each block, and `each` for each reference.
  TestCost(int block, float whole, float each)
      : inverse_block_(1.0f / static_cast<float>(block)),
        round_up_(static_cast<float>(block - 1)),
        whole_(whole),
        each_(each) {}

  // Returns the tests that leaves of n references take.
  HWY_ATTR V operator()(V n) const {
    const Floats d;
    const V blocks = hn::Floor(hn::Mul(hn::Add(n, hn::Set(d, round_up_)), hn::Set(d, inverse_block_)));
    return hn::Add(hn::Mul(blocks, hn::Set(d, whole_)), hn::Mul(n, hn::Set(d, each_)));
  }
  HWY_ATTR float of(std::size_t n) const {
    return hn::GetLane((*this)(hn::Set(Floats(), static_cast<float>(n))));
  }

 private:
  float inverse_block_, round_up_, whole_, each_;
};

// AxisCosts (kdtree/sah.h) in floats; cheaper_than_leaf (subtree-inl.h) has the rule when to stop.
class PlaneCosts {
 public:
  PlaneCosts(const BuildConfig& config, const Bounds& contents, int axis) : tests_(config.block) {
    const auto k = static_cast<std::size_t>(axis), i = (k + 1) % 3, j = (k + 2) % 3;
    std::array<float, 3> size;
    for (std::size_t a = 0; a < 3; ++a) size[a] = contents.hi[a] - contents.lo[a];
    const float longest = std::max({size[0], size[1], size[2]});
    lo_ = contents.lo[k];
    hi_ = contents.hi[k];
    const float across = size[k] / longest, b = size[i] / longest, c = size[j] / longest;
    // A cell that is a line has no surface: shares are those of its length.
    const float area = across * b + b * c + c * across;
    const bool line = !(area > 1e-30f);
    face_ = line ? 0 : b * c / area;
    rim_ = (line ? 1 / across : (b + c) / area) / longest;
    traverse_ = static_cast<float>(config.cost_traverse);
    intersect_ = static_cast<float>(config.cost_intersect);
    usable_ = size[k] > 0 && longest < std::numeric_limits<float>::max();
  }

  // Returns whether there are planes strictly inside.
  bool usable() const { return usable_; }
  float lo() const { return lo_; }
  float hi() const { return hi_; }

  // Infinite where the plane is not strictly inside.
  HWY_ATTR V operator()(V plane, V n_below, V n_above) const {
    const Floats d;
    const V rim = hn::Set(d, rim_), face = hn::Set(d, face_), lo = hn::Set(d, lo_), hi = hn::Set(d, hi_);
    const V below = hn::Add(face, hn::Mul(hn::Sub(plane, lo), rim));
    const V above = hn::Add(face, hn::Mul(hn::Sub(hi, plane), rim));
    const V tests = hn::Add(hn::Mul(below, tests_(n_below)), hn::Mul(above, tests_(n_above)));
    const V cost = hn::Add(hn::Mul(tests, hn::Set(d, intersect_)), hn::Set(d, traverse_));
    const auto inside = hn::And(hn::Lt(lo, plane), hn::Lt(plane, hi));
    return hn::IfThenElse(inside, cost, hn::Set(d, std::numeric_limits<float>::infinity()));
  }

  // Returns false if no plane can be as cheap as a leaf of n references, or as that cost. The two sides share
  // the tests of n references: at best all but one are on the side of the lesser chance. That is at least the
  // face's chance, and the two chances add up to 1 plus the face's.
  bool may_beat(float cost, std::size_t n) const {
    const float one = tests_.of(1), rest = tests_.of(n) - one;
    const float least = traverse_ + intersect_ * (one + face_ * rest);
    return least * (1 - 0x1p-18f) <= std::min(cost, leaf(n));  // the factor is for rounding
  }

  float leaf(std::size_t n) const { return intersect_ * tests_.of(n); }

 private:
  TestCost tests_;
  float lo_, hi_, face_, rim_, traverse_, intersect_;
  bool usable_;
};

// Returns the axes, that of the cell's longest edge first: the best plane is likely to lie across it, and
// then rules out planes across others.
inline std::array<int, 3> longest_first(const Bounds& b) {
  const auto length = [&](int axis) {
    const auto k = static_cast<std::size_t>(axis);
    return b.hi[k] - b.lo[k];
  };
  std::array<int, 3> axes{0, 1, 2};
  if (length(axes[1]) > length(axes[0])) std::swap(axes[0], axes[1]);
  if (length(axes[2]) > length(axes[0])) std::swap(axes[0], axes[2]);
  if (length(axes[2]) > length(axes[1])) std::swap(axes[1], axes[2]);
  return axes;
}

// The cheapest plane so far.
struct Best {
  float cost = std::numeric_limits<float>::infinity();
  Plane plane;

  void offer(float c, int axis, float position) {
    const bool nearer = axis == plane.axis ? position < plane.position : axis < plane.axis;
    if (c < cost || (c == cost && plane.found() && nearer)) {
      cost = c;
      plane = {axis, position};
    }
  }
};

// The cheapest plane so far in every lane of a vector, for one axis.
class BestOfAxis {
 public:
  HWY_ATTR BestOfAxis()
      : cost_(hn::Set(Floats(), std::numeric_limits<float>::infinity())), position_(hn::Zero(Floats())) {}

  HWY_ATTR void offer(V cost, V position) {
    const auto better =
        hn::Or(hn::Lt(cost, cost_), hn::And(hn::Eq(cost, cost_), hn::Lt(position, position_)));
    cost_ = hn::IfThenElse(better, cost, cost_);
    position_ = hn::IfThenElse(better, position, position_);
  }

  HWY_ATTR void offer_to(Best& best, int axis) const {
    const Floats d;
    const float least = hn::GetLane(hn::MinOfLanes(d, cost_));
    if (!(least < std::numeric_limits<float>::infinity())) return;
    const V ties = hn::IfThenElse(hn::Eq(cost_, hn::Set(d, least)), position_,
                                  hn::Set(d, std::numeric_limits<float>::infinity()));
    best.offer(least, axis, hn::GetLane(hn::MinOfLanes(d, ties)));
  }

 private:
  V cost_, position_;
};

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
