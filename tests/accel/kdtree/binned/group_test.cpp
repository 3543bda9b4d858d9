// Groups: the best part there is, by an oracle in long double; and what is left whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "accel/kdtree/build.h"
#include "accel/kdtree/check_tree.h"
#include "accel/kdtree/fragment.h"
#include "kdray/error.h"

namespace kdray::test {
namespace {

using kdtree::BoundedRef;
using kdtree::Bounds;
using kdtree::BuildConfig;
using kdtree::Fragment;
using kdtree::Node;
using Real = long double;

Real size_of(const Bounds& b) {
  Real e[3];
  for (std::size_t k = 0; k < 3; ++k) e[k] = static_cast<Real>(b.hi[k]) - b.lo[k];
  return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

Real tests_of(std::size_t n, const BuildConfig& c) {
  const Real each = std::max(1e-3L, static_cast<Real>(c.group_each));
  return (1 - static_cast<Real>(c.group_each)) * std::ceil(static_cast<Real>(n) / c.block) +
         each * static_cast<Real>(n);
}

// The cost of a division into these two, relative to their hull.
Real cost_of(std::span<const BoundedRef> first, std::span<const BoundedRef> second, const Bounds& hull,
             const BuildConfig& c) {
  const Real sum = size_of(kdtree::hull_of(first)) * tests_of(first.size(), c) +
                   size_of(kdtree::hull_of(second)) * tests_of(second.size(), c);
  return static_cast<Real>(c.group_traverse) + sum / size_of(hull);
}

Real center_of(const BoundedRef& r, std::size_t k) {
  return static_cast<Real>(r.lo[k]) + r.hi[k];
}

// How far apart the centres are along an axis.
Real width_of(const std::vector<BoundedRef>& refs, std::size_t k) {
  const auto [least, most] = std::minmax_element(refs.begin(), refs.end(), [k](const auto& a, const auto& b) {
    return center_of(a, k) < center_of(b, k);
  });
  return center_of(*most, k) - center_of(*least, k);
}

// The least cost of all divisions by the order of centres along an axis that is not narrow: half as wide as
// the widest. The builder's numbers may make one wide that is just below.
Real least_cost(std::vector<BoundedRef> refs, const Bounds& hull, const BuildConfig& c) {
  Real least = std::numeric_limits<Real>::infinity();
  const Real widest = std::max({width_of(refs, 0), width_of(refs, 1), width_of(refs, 2)});
  for (std::size_t k = 0; k < 3; ++k) {
    if (2 * width_of(refs, k) < 1.001L * widest) continue;
    const auto center = [k](const BoundedRef& r) { return center_of(r, k); };
    std::sort(refs.begin(), refs.end(), [&](const auto& a, const auto& b) { return center(a) < center(b); });
    for (std::size_t i = 1; i < refs.size(); ++i)
      if (center(refs[i - 1]) < center(refs[i]))
        least = std::min(least, cost_of(std::span(refs).first(i), std::span(refs).subspan(i), hull, c));
  }
  return least;
}

std::vector<BoundedRef> random_refs(Random& random, std::size_t n, float size) {
  std::vector<BoundedRef> refs;
  for (std::size_t i = 0; i < n; ++i) {
    BoundedRef r{};
    r.ref = static_cast<kdtree::Ref>(i);
    for (std::size_t k = 0; k < 3; ++k) {
      r.lo[k] = uniform(random, -4, 4);
      r.hi[k] = r.lo[k] + uniform(random, 0, size);
    }
    refs.push_back(r);
  }
  return refs;
}

Fragment groups_of(std::vector<BoundedRef> refs, const BuildConfig& config) {
  Fragment out;
  const Bounds hull = kdtree::hull_of(refs);
  kdtree::append_cell(refs, hull, 3, config, out);
  EXPECT_EQ(out.max_depth, 3);  // planes alone make depth
  return out;
}

// What is below a node of the fragment.
std::vector<BoundedRef> refs_below(const Fragment& f, std::uint32_t node,
                                   const std::vector<BoundedRef>& refs) {
  if (!f.nodes[node].is_leaf()) {
    std::vector<BoundedRef> all = refs_below(f, f.nodes[node].left, refs);
    for (const BoundedRef& r : refs_below(f, f.nodes[node].right, refs)) all.push_back(r);
    return all;
  }
  std::vector<BoundedRef> all;
  for (std::uint32_t i = 0; i < f.nodes[node].right; ++i) all.push_back(refs[f.refs[f.nodes[node].left + i]]);
  return all;
}

BuildConfig grouped(int block, double each) {
  BuildConfig c;
  c.groups = true;
  c.block = block;
  c.group_each = each;
  c.quality = kdtree::Quality::best;  // cells of any size
  return c;
}

// Every node of the groups, from the whole cell down. The builder's numbers have 1/32000 of the hull's
// longest edge.
TEST(Groups, NoOtherPartIsCheaper) {
  Random random(61);
  int n_parted = 0, n_whole = 0;
  for (int trial = 0; trial < 400; ++trial) {
    SCOPED_TRACE(trial);
    const BuildConfig c = grouped(trial % 2 == 0 ? 4 : 8, trial % 3 == 0 ? 0 : 0.5);
    const auto refs =
        random_refs(random, 2 + static_cast<std::size_t>(trial) % 47, trial % 5 == 0 ? 6.0f : 1.0f);
    const Fragment f = groups_of(refs, c);
    for (std::uint32_t i = 0; i < f.nodes.size(); ++i) {
      const auto here = refs_below(f, i, refs);
      const Bounds hull = kdtree::hull_of(here);
      EXPECT_EQ(f.contents[i].lo, kdtree::box_from(hull).lo);
      EXPECT_EQ(f.contents[i].hi, kdtree::box_from(hull).hi);
      const Real least = least_cost(here, hull, c), whole = tests_of(here.size(), c);
      const Real slack = 2e-3L * whole;
      if (f.nodes[i].is_leaf()) {
        if (c.group_each == 0 && here.size() <= static_cast<std::size_t>(c.block)) continue;
        EXPECT_GE(least, whole - slack);
        ++n_whole;
        continue;
      }
      const Real cost =
          cost_of(refs_below(f, f.nodes[i].left, refs), refs_below(f, f.nodes[i].right, refs), hull, c);
      EXPECT_LE(cost, least + slack);
      EXPECT_LT(cost, whole + slack);
      ++n_parted;
    }
  }
  EXPECT_GT(n_parted, 2000);
  EXPECT_GT(n_whole, 1000);
}

// Above a few dozen, sixteen steps along each axis are tried: two heaps come apart.
TEST(Groups, LargeHeapsComeApart) {
  Random random(62);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<BoundedRef> refs = random_refs(random, 400, 0.5f);
    for (std::size_t i = 0; i < refs.size(); ++i) {
      const auto k = static_cast<std::size_t>(axis);
      if (i % 2 == 0) refs[i].lo[k] += 100, refs[i].hi[k] += 100;
    }
    const Fragment f = groups_of(refs, grouped(4, 0.5));
    ASSERT_TRUE(f.nodes[0].has_groups());
    EXPECT_EQ(f.nodes[0].order_axis(), static_cast<std::uint32_t>(axis));
    const auto first = refs_below(f, f.nodes[0].left, refs);
    EXPECT_EQ(first.size(), 200u);
    for (const BoundedRef& r : first) EXPECT_EQ(r.ref % 2, 1u);
  }
}

// Such cells are there where a budget has ended the planes: the time that they would take is for `best`
// alone.
TEST(Groups, HugeCellsAreForThoseWhoWait) {
  Random random(64);
  const auto refs = random_refs(random, 2100, 0.5f);
  BuildConfig c = grouped(4, 0.5);
  EXPECT_GT(groups_of(refs, c).nodes.size(), 500u);
  c.quality = kdtree::Quality::balanced;
  EXPECT_EQ(groups_of(refs, c).nodes.size(), 1u);
  EXPECT_GT(groups_of({refs.begin(), refs.begin() + 2000}, c).nodes.size(), 500u);
}

TEST(Groups, WhatCannotBePartedStaysWhole) {
  for (const std::size_t n : {2u, 40u, 500u, 100000u}) {
    SCOPED_TRACE(n);
    std::vector<BoundedRef> refs(n);
    for (std::size_t i = 0; i < n; ++i) refs[i] = {{0, 1, 2}, static_cast<kdtree::Ref>(i), {3, 3, 3}};
    EXPECT_EQ(groups_of(refs, grouped(4, 0.5)).nodes.size(), 1u);
    for (BoundedRef& r : refs) r.lo = r.hi = {1, 1, 1};  // a point
    EXPECT_EQ(groups_of(refs, grouped(4, 0.5)).nodes.size(), 1u);
  }
}

// On a line, which has no surface, lengths count.
TEST(Groups, ALineComesApart) {
  std::vector<BoundedRef> refs(64);
  for (std::size_t i = 0; i < refs.size(); ++i) {
    const float x = static_cast<float>(i) * 16;
    refs[i] = {{0, x, 2}, static_cast<kdtree::Ref>(i), {0, x + 1, 2}};
  }
  const Fragment f = groups_of(refs, grouped(4, 0.5));
  EXPECT_GT(f.nodes.size(), 15u);
  for (const Node& n : f.nodes) {
    if (n.is_leaf()) {
      EXPECT_LE(n.right, 8u);
    } else {
      EXPECT_EQ(n.order_axis(), 1u);
    }
  }
}

// Whatever the scale; where products or lengths overflow, whole or not.
TEST(Groups, AnyScale) {
  Random random(63);
  const std::vector<BoundedRef> plain = random_refs(random, 300, 0.5f);
  for (const int exponent : {-148, -140, -126, -60, 0, 60, 120, 125}) {
    SCOPED_TRACE(exponent);
    std::vector<BoundedRef> refs = plain;
    for (BoundedRef& r : refs)
      for (std::size_t k = 0; k < 3; ++k) {
        r.lo[k] = std::ldexp(r.lo[k], exponent);
        r.hi[k] = std::ldexp(r.hi[k], exponent);
      }
    const Fragment f = groups_of(refs, grouped(4, 0.5));
    std::vector<kdtree::Ref> all = f.refs;
    std::sort(all.begin(), all.end());
    ASSERT_EQ(all.size(), refs.size());
    for (std::size_t i = 0; i < all.size(); ++i) ASSERT_EQ(all[i], i);
    if (exponent >= -60 && exponent <= 60) {
      EXPECT_GT(f.nodes.size(), 100u);
    }
  }
}

// Each one twice as large as the one before, about one corner: parted one by one, to a depth that is bounded.
TEST(Groups, DepthIsBounded) {
  std::vector<BoundedRef> refs(120);
  for (std::size_t i = 0; i < refs.size(); ++i) {
    const float s = std::ldexp(1.0f, static_cast<int>(i) - 60);
    refs[i] = {{s, s, s}, static_cast<kdtree::Ref>(i), {1.5f * s, 1.5f * s, 1.5f * s}};
  }
  const Fragment f = groups_of(refs, grouped(4, 0.5));
  std::vector<int> level(f.nodes.size(), 0);
  for (std::size_t i = 0; i < f.nodes.size(); ++i) {
    EXPECT_LE(level[i], 64);
    if (f.nodes[i].has_groups()) level[f.nodes[i].left] = level[f.nodes[i].right] = level[i] + 1;
  }
  EXPECT_GT(*std::max_element(level.begin(), level.end()), 20);
}

TEST(Groups, SenselessCostsAreRefused) {
  for (const double bad : {-1.0, static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    BuildConfig traverse, each;
    traverse.group_traverse = bad;
    each.group_each = bad;
    EXPECT_THROW(kdtree::build({}, traverse), Error) << bad;
    EXPECT_THROW(kdtree::build({}, each), Error) << bad;
  }
}

}  // namespace
}  // namespace kdray::test
