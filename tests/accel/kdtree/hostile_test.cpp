// Inputs made to break a builder: it must end soon, with bounded memory and a valid tree.
#include <gtest/gtest.h>

#include <cmath>

#include "accel/kdtree/build.h"
#include "accel/kdtree/check_tree.h"
#include "accel/kdtree/exact/exact.h"

namespace kdray::test {
namespace {

void check_hostile(const scene::Geometry& g, kdtree::Quality quality, bool groups) {
  SCOPED_TRACE(testing::Message() << "quality " << static_cast<int>(quality) << (groups ? ", groups" : ""));
  kdtree::BuildConfig config;
  config.quality = quality;
  config.groups = groups;
  const kdtree::Tree tree = kdtree::build(g, config);
  EXPECT_LE(static_cast<double>(tree.refs.size()), kdtree::reference_budget(g.size(), quality));
  // Every leaf that holds something costs a reference; empty ones are cut off at most six times in a row.
  EXPECT_LE(tree.nodes.size(), 16 * (tree.refs.size() + 1));
  check_shape(tree, g, 64);
  if (!testing::Test::HasFatalFailure()) check_complete(tree, g, 7, 77);
}

void check_hostile(const scene::Geometry& g, kdtree::Quality quality) {
  for (const bool groups : {false, true}) check_hostile(g, quality, groups);
}

void check_hostile(const scene::Geometry& g) {
  for (const auto quality : {kdtree::Quality::fast, kdtree::Quality::balanced, kdtree::Quality::best})
    check_hostile(g, quality);
}

// Needles go from anywhere to anywhere in the scene, one edge about as short as `width`.
void add_needles(scene::Geometry& g, Random& random, int n, float width) {
  for (int i = 0; i < n; ++i) {
    const vec3 a = random_vec3(random, -8, 8);
    add_triangle(g, a, random_vec3(random, -8, 8), a + random_vec3(random, -1, 1) * width);
  }
}

TEST(Hostile, AllTheSame) {
  scene::Geometry g;
  for (int i = 0; i < 30000; ++i) add_triangle(g, {0, 0, 0}, {1, 0, 0.25f}, {0, 1, 0.5f});
  check_hostile(g);
}

TEST(Hostile, AllInOnePoint) {
  Random random(21);
  scene::Geometry g;
  const auto near = [&](const vec3& v) { return v * 0x1p-30f; };
  for (int i = 0; i < 20000; ++i)
    add_triangle(g, near(random_vec3(random, -1, 1)), near(random_vec3(random, -1, 1)),
                 near(random_vec3(random, -1, 1)));
  check_hostile(g);
  add_triangle(g, {-64, -64, -64}, {64, 0, 0}, {0, 64, 64});  // and something that makes the scene large
  const kdtree::Tree tree = kdtree::build(g);
  check_shape(tree, g, 64);
}

TEST(Hostile, FanAboutOneVertex) {
  Random random(22);
  scene::Geometry g;
  for (int i = 0; i < 3000; ++i)
    add_triangle(g, {0, 0, 0}, random_vec3(random, -1, 1), random_vec3(random, -1, 1));
  check_hostile(g);
}

TEST(Hostile, Slivers) {
  Random random(23);
  scene::Geometry g;
  add_needles(g, random, 3000, 0x1p-4f);
  check_hostile(g);
}

// So many that the budget ends splits in cells that all threads divide together.
TEST(Hostile, NeedlesAcrossTheScene) {
  Random random(27);
  scene::Geometry g;
  add_needles(g, random, 60000, 0x1p-8f);
  check_hostile(g, kdtree::Quality::fast);
  check_hostile(g, kdtree::Quality::balanced);
}

TEST(Hostile, NeedlesInOnePlane) {
  Random random(24);
  scene::Geometry g;
  add_needles(g, random, 3000, 0x1p-4f);
  for (auto& t : g.triangles) {
    for (auto& v : t.v) v[2] = 0;
  }
  check_hostile(g);
}

// Triangles without area: anywhere, along the axes, and all on one line.
TEST(Hostile, ZeroAreaTriangles) {
  Random random(28);
  for (int sort = 0; sort < 3; ++sort) {
    SCOPED_TRACE(sort);
    scene::Geometry g;
    for (int i = 0; i < 3000; ++i) {
      const vec3 place = sort == 2 ? vec3(uniform(random, -8, 8)) : random_vec3(random, -8, 8);
      vec3 way = sort == 2 ? vec3(uniform(random, 0.01f, 2)) : random_vec3(random, -2, 2);
      if (sort == 1) way = vec3(i % 3 == 0, i % 3 == 1, i % 3 == 2) * way;
      add_triangle(g, place, place + 0.25f * way, place + way);
    }
    check_hostile(g);
  }
}

TEST(Hostile, CoplanarLayers) {
  scene::Geometry g;
  for (int layer = 0; layer < 40; ++layer) {
    for (int i = 0; i < 200; ++i) add_triangle(g, {0, 0, layer}, {4, 0, layer}, {0, 4, layer});
  }
  check_hostile(g);
}

TEST(Hostile, OneHugeAndManyTiny) {
  Random random(25);
  scene::Geometry g;
  add_triangles(g, random, 10000, 0.02f);
  add_triangle(g, {-65536, -65536, 1}, {65536, -65536, 3}, {0, 65536, -3});
  check_hostile(g);
}

TEST(Hostile, NestedSpheres) {
  scene::Geometry g;
  for (int i = 1; i <= 3000; ++i) g.spheres.push_back({{0, 0, 0}, static_cast<float>(i) / 3000, 0});
  check_hostile(g);
}

TEST(Hostile, ExtremeScales) {
  for (const float scale : {0x1p-100f, 0x1p+110f}) {
    Random random(26);
    scene::Geometry g;
    add_triangles(g, random, 2000, 1);
    for (auto& t : g.triangles) {
      for (auto& v : t.v)
        for (float& x : v) x *= scale;
    }
    SCOPED_TRACE(scale);
    check_hostile(g);
    EXPECT_GT(kdtree::build(g).nodes.size(), 1000u);  // scale is no reason not to split
  }
}

}  // namespace
}  // namespace kdray::test
