// What    is promised of closest points beside their distance: the same bits whatever the tree, the order of
//         points and the
// vectors of the device; what a radius leaves out; weights; and what input is refused.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "engine/query/closest_scenes.h"
#include "engine/query/device_scene.h"
#include "engine/query/point_session.h"
#include "support/device.h"
#include "support/errors.h"

namespace kdray::test {
namespace {

using query::ClosestPoint;

constexpr double kInfinity = std::numeric_limits<double>::infinity(),
                 kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<ClosestPoint> ask(DeviceScene& queried, const std::vector<dvec3>& points,
                              double radius = kInfinity) {
  return query::closest_points(queried.target(), points, radius).points;
}

bool same(const ClosestPoint& a, const ClosestPoint& b) {
  return a.distance == b.distance && a.point == b.point && a.primitive == b.primitive && a.u == b.u &&
         a.v == b.v;
}

class ClosestPromises : public EachDevice {};

TEST_P(ClosestPromises, TheSameBitsByAnyTree) {
  for (const scene::Scene& scene : {soup(400, 3), grid(12), ball(10), all_kinds()}) {
    DeviceScene queried(scene, GetParam());
    const std::vector<dvec3> points = points_for(queried, 4000);
    const std::vector<ClosestPoint> usual = ask(queried, points);
    for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::best})
      for (const int depth : {-1, 3}) {
        DeviceScene other(scene, GetParam(), "", {.quality = quality, .max_depth = depth});
        EXPECT_TRUE(std::ranges::equal(usual, ask(other, points), same)) << "depth " << depth;
      }
  }
}

TEST_P(ClosestPromises, TheSameBitsByPlainVectors) {
  DeviceScene queried(all_kinds(), GetParam()), plain(all_kinds(), GetParam(), "-DKDRAY_SIMD=0");
  const std::vector<dvec3> points = points_for(queried, 4000);
  EXPECT_TRUE(std::ranges::equal(ask(queried, points), ask(plain, points), same));
}

TEST_P(ClosestPromises, TheSameBitsInAnyOrderAndManyChunks) {
  DeviceScene queried(soup(100, 1), GetParam());
  const std::vector<dvec3> some = points_for(queried, 1000);
  const std::vector<ClosestPoint> usual = ask(queried, some);
  std::vector<dvec3> many;
  while (many.size() < 700000) many.insert(many.end(), some.rbegin(), some.rend());
  const std::vector<ClosestPoint> answers = ask(queried, many);
  ASSERT_EQ(answers.size(), many.size());
  for (std::size_t i = 0; i < answers.size(); ++i)
    ASSERT_TRUE(same(answers[i], usual[some.size() - 1 - i % some.size()])) << i;
}

TEST_P(ClosestPromises, ARadiusLeavesOutWhatIsFarther) {
  for (const scene::Scene& scene : {soup(200, 1), all_kinds()}) {
    DeviceScene queried(scene, GetParam());
    const std::vector<dvec3> points = points_for(queried, 4000);
    const std::vector<ClosestPoint> all = ask(queried, points);
    // As far as some of them are: these are found.
    for (const double radius : {0.0, all[1].distance, all[300].distance, all[900].distance, 1e5, 1e200}) {
      const std::vector<ClosestPoint> near = ask(queried, points, radius);
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (all[i].distance <= radius) {
          ASSERT_TRUE(same(near[i], all[i])) << i << ", radius " << radius;
        } else {
          ASSERT_EQ(near[i].primitive, -1) << i << ", radius " << radius;
          ASSERT_EQ(near[i].distance, kInfinity);
        }
      }
    }
  }
}

TEST_P(ClosestPromises, WeightsAreExactAtCornersAndOnEdges) {
  scene::Scene s = empty_scene();
  add_triangle(s, {0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  DeviceScene queried(s, GetParam());
  const std::vector<ClosestPoint> found = ask(
      queried,
      {{-1, -1, 3}, {5, -0.5, 1}, {-0.5, 5, -1}, {1, -2, 0.5}, {-2, 3, 0}, {3, 3, 1}, {1, 2, 7}, {1, 1, 0}});
  const float weights[][2] = {{0, 0},     {1, 0},       {0, 1},        {0.25f, 0},
                              {0, 0.75f}, {0.5f, 0.5f}, {0.25f, 0.5f}, {0.25f, 0.25f}};
  const dvec3 places[] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 0, 0},
                          {0, 3, 0}, {2, 2, 0}, {1, 2, 0}, {1, 1, 0}};
  const double squares[] = {11, 2.25, 2.25, 4.25, 4, 3, 49, 0};
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].u, weights[i][0]) << i;
    EXPECT_EQ(found[i].v, weights[i][1]) << i;
    EXPECT_EQ(found[i].point, places[i]) << i;
    EXPECT_DOUBLE_EQ(found[i].distance, std::sqrt(squares[i])) << i;
  }
}

// A ball's corners are equally far from its middle but for rounding: more candidates than the list holds.
TEST_P(ClosestPromises, OfAllEquallyFarTheSmallestNumber) {
  scene::Scene s = empty_scene();
  for (int i = 0; i < 100; ++i)  // about an axis, in an order of its own
    for (const double side : {1.0, -1.0}) {
      const double a = 0.1 * ((i * 37) % 100);
      add_triangle(s, {0, 0, side}, {std::cos(a), std::sin(a), 2 * side},
                   {-std::sin(a), std::cos(a), 2 * side});
    }
  DeviceScene queried(s, GetParam());
  for (const ClosestPoint& found : ask(queried, {{0, 0, 0}, {0, 0, -0.25}, {0, 0, 0.25}})) {
    EXPECT_EQ(found.primitive, found.point.z > 0 ? 0 : 1);
    EXPECT_EQ(std::abs(found.point.z), 1);
  }
}

TEST_P(ClosestPromises, OfNothingThereIsNothing) {
  DeviceScene nothing(empty_scene(), GetParam());
  const std::vector<ClosestPoint> found = ask(nothing, {{1, 2, 3}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].primitive, -1);
  EXPECT_EQ(found[0].distance, kInfinity);
  DeviceScene something(soup(3, 0), GetParam());
  EXPECT_TRUE(ask(something, {}).empty());
}

TEST_P(ClosestPromises, PointsAtTheEndOfDoublesAreAnswered) {
  for (const double size : {1e-300, 1.0, 1e300}) {
    DeviceScene queried(moved(soup(20, 0), size, dvec3(0)), GetParam());
    const std::vector<dvec3> points = {
        {1e308, 0, 0}, {-0.9e308, 0.9e308, 0.9e308}, {1e20, 0, 1e19}, {0, 0, 1e-308}, {0, 0, 0}};
    const std::vector<ClosestPoint> found = ask(queried, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_GE(found[i].primitive, 0) << i << " at size " << size;
      EXPECT_FALSE(std::isnan(found[i].distance));
      const double expected = safe_length(0.25 * points[i] - 0.25 * found[i].point);
      EXPECT_NEAR(0.25 * found[i].distance / expected, 1, 1e-9) << i << " at size " << size;
    }
  }
}

// Where the way from the scene's centre is no double.
TEST_P(ClosestPromises, ScenesAtTheEndOfDoublesAreToo) {
  DeviceScene queried(moved(soup(20, 0), 1e307, {-1e308, 0, 0}), GetParam());
  const std::vector<dvec3> points = {{0.5e308, 0, 0}, {1.6e308, 1e307, 0}, {-1e308, 1e306, 3e306}};
  const std::vector<ClosestPoint> found = ask(queried, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_GE(found[i].primitive, 0) << i;
    const double expected = safe_length(0.25 * points[i] - 0.25 * found[i].point);
    if (4 * expected < kInfinity) {
      EXPECT_NEAR(0.25 * found[i].distance / expected, 1, 1e-9) << i;
    }
  }
}

TEST_P(ClosestPromises, WhatIsNoPointIsRefused) {
  DeviceScene queried(soup(3, 0), GetParam());
  const auto with = [&](const dvec3& point, double radius) {
    return [&, point, radius] { ask(queried, {{0, 0, 0}, point}, radius); };
  };
  EXPECT_TRUE(fails(with({kNan, 0, 0}, kInfinity), "point 1: it is not finite"));
  EXPECT_TRUE(fails(with({0, kInfinity, 0}, kInfinity), "point 1: it is not finite"));
  EXPECT_TRUE(fails(with({0, 0, 0}, kNan), "radius"));
  EXPECT_TRUE(fails(with({0, 0, 0}, -1), "radius"));
  const std::vector<dvec3> points = {{0, 0, 0}, {0, 0, -kInfinity}};
  EXPECT_EQ(query::first_not_finite(points), 1u);
  EXPECT_EQ(query::first_not_finite({}), 0u);
}

// What a walk stacks that leaves all children but one of each node behind, on the way to any leaf.
int needed(const flatten::WideForm& wide, std::uint32_t index) {
  const layout::WideNode& node = wide.nodes[index];
  int n = 0, below = 0;
  for (int slot = 0; slot < 8; ++slot) {
    if (!(node.bounds[0][0][slot] <= node.bounds[0][1][slot])) continue;
    ++n;
    if (!(node.child[slot] & KDRAY_WIDE_LEAF)) below = std::max(below, needed(wide, node.child[slot]));
  }
  return n - 1 + std::max(below, 1);
}

TEST_P(ClosestPromises, TheStackHoldsTheDeepestTree) {
  for (const scene::Scene& scene : {soup(1, 0), soup(3000, 5), slivers(2000), all_kinds(), grid(40)})
    for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::best}) {
      DeviceScene queried(scene, GetParam(), "", {.quality = quality});
      EXPECT_LE(needed(queried.prepared().wide, 0),
                wavefront::any_order_stack_size(queried.prepared().tree_depth));
    }
}

KDRAY_FOR_EACH_DEVICE(ClosestPromises);

}  // namespace
}  // namespace kdray::test
