#include "accel/kdtree/statistics.h"

#include <gtest/gtest.h>

#include <numeric>

#include "accel/kdtree/shapes.h"

namespace kdray::test {
namespace {

using kdtree::Node;
using kdtree::Statistics;
using kdtree::Tree;

// x < 1: one reference; above it, y < 1: none; else two.
Tree small_tree() {
  Tree t;
  t.bounds = {vec3(0), vec3(4, 2, 1)};
  t.nodes = {
      {0, 1, 1, 2}, {Node::kLeaf, 0, 0, 1}, {1, 1, 3, 4}, {Node::kLeaf, 0, 1, 0}, {Node::kLeaf, 0, 1, 2}};
  t.refs = {0, 0, 1};
  const Box left(vec3(0), vec3(1, 1, 0)), right(vec3(1, 1, 0), vec3(4, 2, 1));
  t.contents = {Box(vec3(0), vec3(4, 2, 1)), left, right, Box(), right};
  t.max_depth = 2;
  return t;
}

TEST(Statistics, CountsAndCostByHand) {
  scene::Geometry g;
  for (int i = 0; i < 2; ++i) add_triangle(g, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  kdtree::BuildConfig config;
  config.cost_traverse = 3;
  config.cost_intersect = 5;
  const Statistics s = kdtree::measure(small_tree(), g, config);
  EXPECT_EQ(s.inner_nodes, 2u);
  EXPECT_EQ(s.leaves, 3u);
  EXPECT_EQ(s.empty_leaves, 1u);
  EXPECT_EQ(s.references, 3u);
  EXPECT_EQ(s.leaves_by_size[0], 1u);
  EXPECT_EQ(s.leaves_by_size[1], 1u);
  EXPECT_EQ(s.leaves_by_size[2], 1u);
  EXPECT_EQ(s.largest_leaf, 2u);
  EXPECT_EQ(s.max_depth, 2);
  EXPECT_DOUBLE_EQ(s.mean_leaf_depth, 5.0 / 3);
  EXPECT_DOUBLE_EQ(s.duplication, 1.5);
  // Half areas: root 4*2+2*1+1*4 = 14; left 1*2+2*1+1*1 = 5; right 3*2+2+3 = 11; its upper half 3*1+1+3 = 7.
  EXPECT_DOUBLE_EQ(s.sah_cost, 3 + 5 * 5.0 / 14 + 3 * 11.0 / 14 + 5 * 2 * 7.0 / 14);
  // Half areas of contents: the root's are the cell; left 1*1, right 3*1 + 1 + 3 = 7, as are those of its
  // upper half.
  EXPECT_DOUBLE_EQ(s.tight_cost, 3 + 5 * 1.0 / 14 + 3 * 7.0 / 14 + 5 * 2 * 7.0 / 14);
}

// The last leaf's two references in groups of one: what they cost counts where each is met.
TEST(Statistics, GroupsByHand) {
  Tree t = small_tree();
  t.nodes[4] = {Node::kGroups + 2, 0, 5, 6};
  t.nodes.push_back({Node::kLeaf, 0, 1, 1});
  t.nodes.push_back({Node::kLeaf, 0, 2, 1});
  t.contents.push_back({vec3(1, 1, 0), vec3(2, 2, 0)});
  t.contents.push_back({vec3(1, 1, 0), vec3(4, 2, 0)});
  scene::Geometry g;
  for (int i = 0; i < 2; ++i) add_triangle(g, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  kdtree::BuildConfig config;
  config.cost_traverse = 3;
  config.cost_intersect = 5;
  const Statistics s = kdtree::measure(t, g, config);
  EXPECT_EQ(s.inner_nodes, 2u);
  EXPECT_EQ(s.leaves, 3u);
  EXPECT_EQ(s.groups, 2u);
  EXPECT_EQ(s.references, 3u);
  EXPECT_EQ(s.largest_leaf, 2u);
  EXPECT_EQ(s.leaves_by_size[2], 1u);
  EXPECT_EQ(s.max_depth, 2);
  EXPECT_DOUBLE_EQ(s.sah_cost, 3 + 5 * 5.0 / 14 + 3 * 11.0 / 14 + 5 * 2 * 7.0 / 14);
  // Half areas of the groups: 1 and 3.
  EXPECT_DOUBLE_EQ(s.tight_cost, 3 + 5 * 1.0 / 14 + 3 * 7.0 / 14 + 3 * 7.0 / 14 + 5 * (1 + 3) / 14.0);
}

TEST(Statistics, EmptyTree) {
  const Statistics s = kdtree::measure(kdtree::build({}), {});
  EXPECT_EQ(s.leaves, 1u);
  EXPECT_EQ(s.empty_leaves, 1u);
  EXPECT_EQ(s.sah_cost, 0);
  EXPECT_EQ(s.duplication, 0);
}

TEST(Statistics, BuiltTreeAddsUp) {
  Random random(31);
  const scene::Geometry g = mixed_geometry(random, 1000, 0.5f);
  const Tree tree = kdtree::build(g);
  const Statistics s = kdtree::measure(tree, g);
  EXPECT_EQ(s.inner_nodes + s.leaves, tree.nodes.size());
  EXPECT_EQ(s.leaves, s.inner_nodes + 1);
  EXPECT_EQ(s.references, tree.refs.size());
  EXPECT_EQ(s.max_depth, tree.max_depth);
  EXPECT_EQ(std::accumulate(s.leaves_by_size.begin(), s.leaves_by_size.end(), std::uint64_t{0}), s.leaves);
  // A tree is built because it is cheaper than testing everything, by far.
  EXPECT_LT(s.sah_cost, 1.5 * static_cast<double>(g.size()) / 20);
}

}  // namespace
}  // namespace kdray::test
