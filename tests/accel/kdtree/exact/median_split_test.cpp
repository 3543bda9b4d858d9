// The thesis' medians: planes where they say, trees as valid as any other.
#include "accel/kdtree/exact/exact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "accel/kdtree/build.h"
#include "accel/kdtree/check_tree.h"

namespace kdray::test {
namespace {

using kdtree::BoundedRef;
using kdtree::BuildConfig;
using kdtree::median_split;
using kdtree::Split;
using kdtree::SplitRule;
using kdtree::Tree;

constexpr SplitRule kRules[] = {SplitRule::spatial_median, SplitRule::object_median};

BuildConfig config_of(SplitRule rule) {
  BuildConfig config;
  config.quality = kdtree::Quality::best;
  config.split_rule = rule;
  return config;
}

void check_rule(const scene::Geometry& g, SplitRule rule) {
  SCOPED_TRACE(rule == SplitRule::spatial_median ? "spatial" : "object");
  const Tree tree = kdtree::build(g, config_of(rule));
  check_shape(tree, g, static_cast<int>(8 + 1.3 * std::log2(static_cast<double>(g.size()))));
  if (!testing::Test::HasFatalFailure()) check_complete(tree, g, 12, 99);
}

// Boxes of one unit along y at 0, 1, 4, 9, ..., in a cell that is longest along y.
std::vector<BoundedRef> row(int n) {
  std::vector<BoundedRef> refs;
  for (int i = 0; i < n; ++i) {
    const auto y = static_cast<float>(i * i);
    refs.push_back({{0, y, 0}, static_cast<std::uint32_t>(i), {1, y + 1, 1}});
  }
  return refs;
}

TEST(MedianSplit, SpatialIsTheMiddleOfTheLongestAxis) {
  const Split s = median_split(row(11), {{0, 0, 0}, {1, 101, 1}}, SplitRule::spatial_median);
  EXPECT_EQ(s.axis, 1);
  EXPECT_EQ(s.position, 50.5f);
}

TEST(MedianSplit, ObjectIsTheMedianOfTheCenters) {
  const Split s = median_split(row(11), {{0, 0, 0}, {1, 101, 1}}, SplitRule::object_median);
  EXPECT_EQ(s.axis, 1);
  EXPECT_EQ(s.position, 25.5f);  // five below, five above
}

TEST(MedianSplit, AFewAreALeaf) {
  for (const SplitRule rule : kRules) {
    EXPECT_FALSE(median_split(row(8), {{0, 0, 0}, {1, 50, 1}}, rule).found());
    EXPECT_TRUE(median_split(row(9), {{0, 0, 0}, {1, 65, 1}}, rule).found());
  }
}

TEST(MedianSplit, ObjectTakesAnotherAxisWhereTheLongestSeparatesNothing) {
  std::vector<BoundedRef> refs;
  for (int i = 0; i < 10; ++i) {
    const auto z = static_cast<float>(i);
    refs.push_back({{0, 0, z}, static_cast<std::uint32_t>(i), {100, 1, z + 1}});
  }
  const Split s = median_split(refs, {{0, 0, 0}, {100, 1, 10}}, SplitRule::object_median);
  EXPECT_EQ(s.axis, 2);
  EXPECT_EQ(s.position, 5.5f);
}

TEST(MedianSplit, NothingCutsWhatIsAllTheSameOrACellWithoutSize) {
  const std::vector<BoundedRef> same(20, BoundedRef{{0, 0, 0}, 0, {1, 1, 1}});
  EXPECT_FALSE(median_split(same, {{0, 0, 0}, {1, 1, 1}}, SplitRule::object_median).found());
  const std::vector<BoundedRef> points(20, BoundedRef{{1, 1, 1}, 0, {1, 1, 1}});
  for (const SplitRule rule : kRules)
    EXPECT_FALSE(median_split(points, {{1, 1, 1}, {1, 1, 1}}, rule).found());
}

TEST(MedianSplit, TreesAreCompleteAndWellFormed) {
  for (const SplitRule rule : kRules) {
    Random random(41);
    for (const float size : {0.1f, 1.0f, 6.0f}) check_rule(mixed_geometry(random, 1500, size), rule);
    for (int trial = 0; trial < 40; ++trial) check_rule(mixed_geometry(random, 2 + trial, 1), rule);
    scene::Geometry architecture;
    add_architecture(architecture, random, 2000);
    check_rule(architecture, rule);
  }
}

// More than a parallel part of the builder takes.
TEST(MedianSplit, LargeTreesToo) {
  Random random(42);
  scene::Geometry g;
  add_triangles(g, random, 20000, 0.2f);
  for (const SplitRule rule : kRules) check_rule(g, rule);
}

TEST(MedianSplit, HostileGeometryEnds) {
  Random random(43);
  scene::Geometry same, fan, flat;
  for (int i = 0; i < 5000; ++i) add_triangle(same, {0, 0, 0}, {1, 0, 0.25f}, {0, 1, 0.5f});
  for (int i = 0; i < 2000; ++i)
    add_triangle(fan, {0, 0, 0}, random_vec3(random, -1, 1), random_vec3(random, -1, 1));
  add_triangles(flat, random, 2000, 0.5f);
  for (auto& t : flat.triangles)
    for (auto& v : t.v) v[1] = 3;
  for (const SplitRule rule : kRules)
    for (const scene::Geometry& g : {same, fan, flat}) check_rule(g, rule);
}

}  // namespace
}  // namespace kdray::test
