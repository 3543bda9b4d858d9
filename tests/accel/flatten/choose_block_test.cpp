// How many primitives a block of the wide form holds: four or eight, by how full leaves would leave it.
#include "accel/flatten/wide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include "accel/kdtree/build.h"
#include "accel/kdtree/shapes.h"

namespace kdray::flatten {
namespace {

using layout::u32;

kdtree::Tree leaves_of_size(std::initializer_list<u32> sizes) {
  kdtree::Tree tree;
  for (const u32 n : sizes) {
    tree.nodes.push_back({.left = static_cast<u32>(tree.refs.size()), .right = n});
    tree.refs.resize(tree.refs.size() + n);
  }
  return tree;
}

TEST(ChooseBlock, EightWhereLeavesFillThemAtLeastHalf) {
  EXPECT_EQ(choose_block(leaves_of_size({8, 7, 8, 6, 16})), 8);
  EXPECT_EQ(choose_block(leaves_of_size({4, 4, 4})), 4);
  EXPECT_EQ(choose_block(leaves_of_size({4, 8, 8})), 8);
  EXPECT_EQ(choose_block(leaves_of_size({4, 4, 3})), 4);
  EXPECT_EQ(choose_block(leaves_of_size({1, 2, 1, 3, 2})), 4);
  EXPECT_EQ(choose_block(leaves_of_size({1, 1, 30, 30})), 8);
}

// It takes as many lanes either way, and a test of eight takes no longer than two of four.
TEST(ChooseBlock, EightWhereFourSavesNothing) {
  EXPECT_EQ(choose_block(leaves_of_size({5, 5, 13})), 8);
  EXPECT_EQ(choose_block(kdtree::build({})), 8);
}

// A sphere's surface in a net of two triangles to a square.
scene::Geometry fine_mesh(int n) {
  const auto point = [n](int i, int j) {
    const double a = 6.283185307179586 * i / n, b = 3.141592653589793 * j / n;
    return vec3(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b));
  };
  scene::Geometry g;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      if (j > 0) test::add_triangle(g, point(i, j), point(i + 1, j), point(i, j + 1));
      if (j + 1 < n) test::add_triangle(g, point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
    }
  return g;
}

TEST(ChooseBlock, FollowsTheTreeThatSuitsTheScene) {
  const kdtree::BuildConfig for_millions = kdtree::suited({}, 1000000);
  EXPECT_EQ(choose_block(kdtree::build(fine_mesh(60), for_millions)), 8);
}

}  // namespace
}  // namespace kdray::flatten
