#include "accel/prepare/prepared.h"

#include <gtest/gtest.h>

#include <cmath>

#include "accel/flatten/features.h"
#include "accel/kdtree/build.h"
#include "base/error.h"

namespace kdray::prepare {
namespace {

// Two triangles, one of no area, and a sphere far from the origin.
scene::Scene small_scene() {
  scene::Scene s;
  s.name = "small";
  s.vertices = {{1000, 0, 0}, {1001, 0, 0}, {1000, 1, 0}};
  s.triangles = {{.vertex = {0, 1, 2}, .number = 0}, {.vertex = {0, 0, 1}, .number = 1}};
  s.spheres = {{.center = {1010, 0, 0}, .radius = 1, .number = 2}};
  s.materials = {{.diffuse = vec3(1)}};
  s.lights = {{.position = {1000, 0, 9}}};
  s.background = vec3(0.25f);
  s.settings.width = 77;
  s.warnings = {"a warning"};
  return s;
}

TEST(Prepared, KeepsAllOfTheSceneButItsPrimitives) {
  const Prepared p = prepare(small_scene(), {});
  EXPECT_EQ(p.settings.name, "small");
  EXPECT_EQ(p.settings.materials, small_scene().materials);
  EXPECT_EQ(p.settings.lights.at(0).position, dvec3(1000, 0, 9));
  EXPECT_EQ(p.settings.background, vec3(0.25f));
  EXPECT_EQ(p.settings.settings.width, 77);
  EXPECT_EQ(p.settings.warnings, small_scene().warnings);
  EXPECT_TRUE(p.settings.triangles.empty() && p.settings.spheres.empty() && p.settings.vertices.empty());
  EXPECT_TRUE(p.geometry.triangles.empty() && p.geometry.spheres.empty());
}

TEST(Prepared, IsTheTreeOfTheGeometry) {
  const TreeOptions options{.max_depth = 1};
  const Prepared p = prepare(small_scene(), options);
  const scene::Geometry geometry = scene::make_geometry(small_scene());
  EXPECT_EQ(p.counts.primitives, 3u);
  EXPECT_EQ(p.counts.triangles, 1u);
  EXPECT_EQ(p.counts.spheres, 1u);
  EXPECT_EQ(p.counts.cones, 0u);
  EXPECT_EQ(p.geometry.dropped_degenerate, 1u);
  EXPECT_EQ(p.geometry.space, geometry.space);
  EXPECT_TRUE(p.geometry.bounds.contains(geometry.bounds));
  EXPECT_EQ(p.features, flatten::features_of(small_scene(), geometry));
  EXPECT_LE(p.tree_depth, 1);
  EXPECT_EQ(p.tree_depth, p.tree.max_depth);
  EXPECT_EQ(p.tree_nodes, p.flat.nodes.size());
  EXPECT_EQ(p.flat.triangles.size(), 1u);
  EXPECT_GT(p.wide.nodes.size(), 0u);
  EXPECT_EQ(p.bytes(), p.flat.bytes() + p.wide.bytes());
  EXPECT_EQ(p.tree_options.max_depth, 1);
  EXPECT_GT(p.seconds.build, 0);
  EXPECT_GT(p.seconds.flatten, 0);
  EXPECT_EQ(p.seconds.load, 0);
}

// A square of n*n little ones, bent.
scene::Scene sheet(std::uint32_t n) {
  scene::Scene s;
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x)
      s.vertices.emplace_back(x, y, 3 * std::sin(0.1 * x) * std::cos(0.1 * y));
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    s.triangles.push_back({.vertex = {a, b, c}, .number = static_cast<std::uint32_t>(s.triangles.size())});
  };
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x;
      add(a, a + 1, a + n + 1);
      add(a + 1, a + n + 2, a + n + 1);
    }
  s.materials = {{.diffuse = vec3(1)}};
  return s;
}

TEST(Prepared, FitsTheMemoryItIsGiven) {
  const scene::Scene scene = sheet(60);
  const Prepared free = prepare(scene, {});
  EXPECT_TRUE(free.settings.warnings.empty());
  const std::uint64_t less = free.bytes() * 23 / 25;
  const Prepared coarse = prepare(scene, {.memory_bytes = less});
  EXPECT_LE(coarse.bytes(), less);
  EXPECT_GT(coarse.tree_nodes, 10u);  // coarser, but a tree
  ASSERT_EQ(coarse.settings.warnings.size(), 1u);
  EXPECT_NE(coarse.settings.warnings[0].find("tracing is slower"), std::string::npos);
  const Prepared enough = prepare(scene, {.memory_bytes = free.bytes()});
  EXPECT_EQ(enough.bytes(), free.bytes());
  EXPECT_TRUE(enough.settings.warnings.empty());
}

TEST(Prepared, HasTheBinaryFormWhereItIsAskedFor) {
  const scene::Scene scene = sheet(10);
  const Prepared both = prepare(scene, {}), wide_alone = prepare(scene, {.binary_form = false});
  EXPECT_EQ(both.flat.nodes.size(), both.tree.inner_nodes + both.tree.leaves);
  EXPECT_EQ(both.flat.refs.size(), both.tree.references);
  EXPECT_TRUE(wide_alone.flat.nodes.empty());
  EXPECT_TRUE(wide_alone.flat.refs.empty());
}

// The binary form's walk tests all that a cell holds; the wide form's have groups.
TEST(Prepared, CellsAreSmallForTheBinaryForm) {
  const scene::Scene scene = sheet(40);
  const Prepared both = prepare(scene, {}), wide_alone = prepare(scene, {.binary_form = false});
  EXPECT_GT(both.tree.leaves, 2 * wide_alone.tree.leaves);
  EXPECT_GT(wide_alone.tree.groups, 2 * wide_alone.tree.leaves);
  EXPECT_LE(wide_alone.tree.duplication, both.tree.duplication);
}

TEST(Prepared, NamesTheLeastThatItTakes) {
  try {
    prepare(sheet(60), {.memory_bytes = 1000});
    FAIL() << "7200 triangles in 1000 bytes";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::out_of_memory);
    EXPECT_NE(std::string(e.what()).find("at least"), std::string::npos);
  }
}

}  // namespace
}  // namespace kdray::prepare
