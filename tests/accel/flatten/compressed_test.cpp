// Compressed nodes against the nodes that they stand for: every box is held, and no plane is off by a whole
// step; and levels are counted as by hand.
#include "accel/flatten/compressed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <random>
#include <span>
#include <string>

#include "layout/instances.layout.h"

namespace kdray::flatten {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr unsigned kSeed = 42;

layout::WideNode empty_node() {
  layout::WideNode node{};
  for (auto& axis : node.bounds)
    for (int slot = 0; slot < 8; ++slot) axis[0][slot] = kInfinity, axis[1][slot] = -kInfinity;
  return node;
}

layout::WideNode parent_of(std::initializer_list<layout::u32> children) {
  layout::WideNode node = empty_node();
  int slot = 0;
  for (const layout::u32 child : children) {
    for (auto& axis : node.bounds) axis[0][slot] = 0, axis[1][slot] = 1;
    node.child[slot++] = child;
  }
  return node;
}

bool has_child(const layout::CompressedNode& node, int slot) {
  return (node.scales >> (24 + slot) & 1u) != 0;
}

double step_along(const layout::CompressedNode& node, int axis) {
  return std::ldexp(1.0, static_cast<int>(node.scales >> (8 * axis) & 255u) - 127);
}

double plane(const layout::CompressedNode& node, int axis, int side, int slot) {
  return double{node.origin[axis]} + step_along(node, axis) * node.bounds[axis][side][slot];
}

// Boxes of all sizes and places: far from 0, flat, a point, one among many, some that are as large as all.
layout::WideNode random_node(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0, 1);
  std::uniform_int_distribution<int> exponents(-40, 20), counts(1, 8), one_of_four(0, 3);
  layout::WideNode node = empty_node();
  const int n = counts(random);
  for (auto& axis : node.bounds) {
    const float size = std::ldexp(1.0f, exponents(random)),
                away = std::ldexp(unit(random), exponents(random));
    for (int slot = 0; slot < n; ++slot) {
      const float lo = away + size * (unit(random) - 0.5f);
      axis[0][slot] = lo;
      axis[1][slot] = one_of_four(random) == 0 ? lo : lo + size * unit(random);
    }
  }
  for (int slot = 0; slot < n; ++slot) node.child[slot] = KDRAY_WIDE_LEAF | static_cast<layout::u32>(slot);
  return node;
}

void check(const layout::WideNode& node) {
  const layout::CompressedNode c = compressed(node);
  for (int slot = 0; slot < 8; ++slot) {
    ASSERT_EQ(c.child[slot], node.child[slot]);
    ASSERT_EQ(has_child(c, slot), node.child[slot] != 0);
    if (node.child[slot] == 0) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const double lo = node.bounds[axis][0][slot], hi = node.bounds[axis][1][slot];
      ASSERT_LE(plane(c, axis, 0, slot), lo);
      ASSERT_GE(plane(c, axis, 1, slot), hi);
      ASSERT_GT(plane(c, axis, 0, slot) + step_along(c, axis), lo);
      ASSERT_LT(plane(c, axis, 1, slot) - step_along(c, axis), hi);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    double least = kInfinity, most = -least;
    for (int slot = 0; slot < 8; ++slot) {
      least = std::min<double>(least, node.bounds[axis][0][slot]);
      most = std::max<double>(most, node.bounds[axis][1][slot]);
    }
    if (most <= least) continue;
    ASSERT_LE(step_along(c, axis), 2 * (most - least) / 255);
  }
}

TEST(Compressed, HoldsEveryBoxAndIsNoWiderThanAStep) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 random(kSeed);
  for (int i = 0; i < 20000; ++i) {
    check(random_node(random));
    if (HasFatalFailure()) return;
  }
}

TEST(Compressed, ANodeWithoutChildrenHasNone) {
  EXPECT_EQ(compressed(empty_node()).scales >> 24, 0u);
}

// As in a mesh that lies behind others: its words were moved, the empty ones' too.
TEST(Compressed, AWordWithoutABoxIsNoChild) {
  layout::WideNode node = empty_node();
  node.child[3] = 7;  // none of the nodes
  EXPECT_EQ(compressed(node).scales >> 24, 0u);
  EXPECT_EQ(most_levels(Array<layout::WideNode>::copy_of(std::span(&node, 1))), 1);
}

TEST(Compressed, AnArrayHasTheSameNodes) {
  std::mt19937 random(kSeed);
  Array<layout::WideNode> nodes(1000);
  for (layout::WideNode& node : nodes) node = random_node(random);
  const Array<layout::CompressedNode> all = compressed(nodes);
  ASSERT_EQ(all.size(), nodes.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const layout::CompressedNode one = compressed(nodes[i]);
    ASSERT_EQ(std::memcmp(&all[i], &one, sizeof one), 0);
  }
}

TEST(Compressed, LevelsAreThoseOfTheLongestWay) {
  const layout::u32 leaf = KDRAY_WIDE_LEAF | 5;
  const layout::WideNode nodes[] = {parent_of({leaf, 1, 3}), parent_of({2, leaf}), parent_of({leaf}),
                                    parent_of({leaf}),       parent_of({5}),       parent_of({6}),
                                    parent_of({7}),          parent_of({leaf})};
  EXPECT_EQ(most_levels(Array<layout::WideNode>::copy_of(std::span(nodes, 4))), 3);
  EXPECT_EQ(most_levels(Array<layout::WideNode>::copy_of(nodes)),
            4);  // a mesh's nodes: no parent in the scene
  EXPECT_EQ(most_levels({}), 0);
}

// Nodes of both are stacked while a ray is in the mesh.
TEST(Compressed, LevelsAboveAnInstanceAreAddedToItsMeshs) {
  const layout::WideNode nodes[] = {parent_of({KDRAY_INSTANCE_LEAF, 1}),
                                    parent_of({KDRAY_INSTANCE_LEAF | 1u}), parent_of({KDRAY_WIDE_LEAF, 3}),
                                    parent_of({KDRAY_WIDE_LEAF})};
  EXPECT_GE(most_levels(Array<layout::WideNode>::copy_of(nodes)), 4);
}

}  // namespace
}  // namespace kdray::flatten
