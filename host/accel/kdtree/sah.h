// What    The cost model: what a split plane is expected to cost a ray that enters the cell, and which of two
//         splits is the better one. This is the exact builder's; the binned one has the same in float
//         (binned/cost-inl.h: TestCost and PlaneCosts). Both have to be changed together.
// Shape   Areas are half surface areas in double: the exact values of float boxes to 2^-50, flat cells
//         included. When a plane is no better than a leaf is decided elsewhere: choose_split in
//         exact/exact.cpp and cheaper_than_leaf in binned/subtree-inl.h.
// Units   BuildConfig's Ct and Ci.
// Source  MacDonald and Booth 1990; Wald and Havran 2006, equations 1 to 4.
#pragma once

#include <cstdint>
#include <limits>

#include "accel/kdtree/build.h"
#include "accel/kdtree/reference.h"

namespace kdray::kdtree {

struct Split {
  int axis = -1;  // -1: none
  float position = 0;
  bool planar_below = true;  // references that lie in the plane go to the child below it
  double cost = std::numeric_limits<double>::infinity();

  bool found() const { return axis >= 0; }
};

// A strict order of splits, so that the best one does not depend on the order of the search.
inline bool better(const Split& a, const Split& b) {
  if (a.cost != b.cost) return a.cost < b.cost;
  if (a.axis != b.axis) return a.axis < b.axis;
  if (a.position != b.position) return a.position < b.position;
  return a.planar_below && !b.planar_below;
}

inline double half_area(const Bounds& b) {
  const double x = static_cast<double>(b.hi[0]) - b.lo[0];
  const double y = static_cast<double>(b.hi[1]) - b.lo[1];
  const double z = static_cast<double>(b.hi[2]) - b.lo[2];
  return x * y + y * z + z * x;
}

class LeafCost {
 public:
  explicit LeafCost(const BuildConfig& config)
      : block_(static_cast<std::uint32_t>(config.block)), each_(config.block > 1 ? kEach : 0) {}

  // Returns the tests that a leaf of n references takes. A full block is a little dearer than one of a single
  // reference, so that of two equal splits the one with fewer duplicates is taken.
  double operator()(std::uint32_t n) const { return (n + block_ - 1) / block_ + each_ * n; }

  // Returns a lower bound for the cost of any leaf of n references.
  double at_least(std::uint32_t n) const { return static_cast<double>(n) / block_ + each_ * n; }

 private:
  static constexpr double kEach = 1e-3;
  std::uint32_t block_;
  double each_;
};

// The expected costs of all planes across one axis of one cell.
class AxisCosts {
 public:
  AxisCosts(const BuildConfig& config, const Bounds& cell, int axis)
      : lo_(cell.lo[axis]),
        hi_(cell.hi[axis]),
        traverse_(config.cost_traverse),
        intersect_(config.cost_intersect / half_area(cell)),
        bonus_(config.empty_bonus),
        tests_(config) {
    const int i = axis == 2 ? 0 : axis + 1, j = i == 2 ? 0 : i + 1;
    const double a = static_cast<double>(cell.hi[i]) - cell.lo[i];
    const double b = static_cast<double>(cell.hi[j]) - cell.lo[j];
    face_ = a * b;
    rim_ = a + b;
  }

  double area_below(double s) const { return face_ + (s - lo_) * rim_; }
  double area_above(double s) const { return face_ + (hi_ - s) * rim_; }

  // Returns the expected cost with n_below and n_above references in the children; cells that cut off empty
  // space are favoured, since a ray leaves them at once.
  double operator()(double s, std::uint32_t n_below, std::uint32_t n_above) const {
    const double cost = sum(area_below(s) * tests_(n_below) + area_above(s) * tests_(n_above));
    return n_below == 0 || n_above == 0 ? bonus_ * cost : cost;
  }

  // Returns what it costs to pass the node and make these tests, weighted by their cells' areas.
  double sum(double weighted_tests) const { return traverse_ + intersect_ * weighted_tests; }
  const LeafCost& tests() const { return tests_; }

  // Returns whether a plane there cuts the cell at all.
  bool inside(float s) const { return lo_ < s && s < hi_; }

  double lo() const { return lo_; }
  double hi() const { return hi_; }
  double bonus() const { return bonus_; }

 private:
  double lo_, hi_, face_, rim_, traverse_, intersect_, bonus_;
  LeafCost tests_;
};

// Offers the plane at s to `best`; n_planar references lie in it. A plane on the cell's own boundary makes a
// flat cell and is of use only for what lies in it.
inline void offer_plane(const AxisCosts& costs, int axis, float s, std::uint32_t n_below,
                        std::uint32_t n_planar, std::uint32_t n_above, Split& best) {
  const bool inside = costs.inside(s);
  if (!inside && n_planar == 0) return;
  if (inside || s == costs.lo()) {
    const Split split{axis, s, true, costs(s, n_below + n_planar, n_above)};
    if (better(split, best)) best = split;
  }
  if (n_planar > 0 && (inside || s == costs.hi())) {
    const Split split{axis, s, false, costs(s, n_below, n_above + n_planar)};
    if (better(split, best)) best = split;
  }
}

}  // namespace kdray::kdtree
