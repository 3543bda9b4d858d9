// The flat arrays hold what scene, geometry and tree say.
#include "accel/flatten/flatten.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "kdray/error.h"

namespace kdray::flatten {
namespace {

scene::Scene mixed_scene() {
  scene::Scene s;
  s.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  s.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  s.triangles = {{.vertex = {0, 1, 2}, .material = 0, .number = 1},
                 {.vertex = {0, 1, 3}, .normal = {0, 1, 2}, .material = 1, .number = 3}};
  s.spheres = {{.center = {2, 0, 0}, .radius = 0.5, .material = 1, .number = 0}};
  s.cones = {
      {.base = {0, 0, 0}, .apex = {0, 0, 4}, .base_radius = 2, .apex_radius = 1, .material = 0, .number = 2}};
  s.discs = {{.center = {1, 0, 0}, .normal = {0, 0, 4}, .radius = 0.5, .material = 1, .number = 4}};
  s.materials = {{.emission = vec3(0.25f), .ambient = vec3(0.5f), .shine = 7},
                 {.transmit = vec3(1), .index = 1.5f}};
  s.ambient = vec3(0.5f);
  return s;
}

kdtree::Tree leaf_of_all() {
  using scene::PrimitiveKind;
  kdtree::Tree tree;
  tree.refs = {kdtree::make_ref(PrimitiveKind::triangle, 0), kdtree::make_ref(PrimitiveKind::triangle, 1),
               kdtree::make_ref(PrimitiveKind::sphere, 0), kdtree::make_ref(PrimitiveKind::cone, 0),
               kdtree::make_ref(PrimitiveKind::disc, 0)};
  tree.nodes = {{.left = 0, .right = 5}};
  return tree;
}

TEST(Flatten, KeepsNumbersMaterialsAndNormals) {
  const scene::Scene s = mixed_scene();
  const scene::Geometry g = scene::make_geometry(s);
  const FlatScene flat = flatten(s, g, leaf_of_all());
  ASSERT_EQ(flat.triangles.size(), 2u);
  EXPECT_EQ(flat.triangles[0].number, 1u);
  EXPECT_EQ(flat.triangles[0].normals, KDRAY_NO_NORMALS);
  EXPECT_EQ(flat.triangles[1].number, 3u);
  ASSERT_EQ(flat.triangles[1].normals, 0u);
  EXPECT_EQ(flat.normals[0].n[1][1], 1.0f);
  const auto scale = static_cast<float>(g.space.scale);
  EXPECT_EQ(flat.spheres[0].radius, 0.5f * scale);
  EXPECT_EQ(flat.spheres[0].number, 0u);
  EXPECT_EQ(flat.cones[0].height, 4.0f * scale);
  EXPECT_EQ(flat.cones[0].slope, -0.25f);
  EXPECT_EQ(flat.cones[0].axis[2], 1.0f);
  EXPECT_EQ(flat.discs[0].radius, 0.5f * scale);
  EXPECT_EQ(flat.discs[0].normal[2], 1.0f);
  EXPECT_EQ(flat.discs[0].number, 4u);
  EXPECT_EQ(flat.materials[0].unshadowed[0], 0.5f);  // emission + ambient * Camb
  EXPECT_EQ(flat.materials[1].index, 1.5f);
}

scene::Light lamp(double scale, const dvec3& position) {
  scene::Light light;
  light.position = position * scale;
  light.attenuation = {0.5, 0.25 / scale, 0.125 / scale / scale};
  light.range = 3 * scale;
  return light;
}

// Whatever the scene's size, a light is where it was among its primitives, and as bright there.
TEST(Flatten, LightsFollowTheScenesScale) {
  for (const int exponent : {-500, -300, -100, 0, 3, 100, 300, 500}) {
    SCOPED_TRACE(exponent);
    const double scale = std::ldexp(1.0, exponent);
    scene::Scene s;
    s.spheres = {{.center = {3 * scale, 0, 0}, .radius = 2 * scale}};
    s.materials.resize(1);
    s.lights = {lamp(scale, {1, 2, 3})};
    const scene::Geometry g = scene::make_geometry(s);
    ASSERT_EQ(g.spheres.size(), 1u);
    const layout::Light light = flatten(s, g, {}).lights[0];
    // The farthest coordinate, 5, becomes 1280: one unit is 256.
    EXPECT_EQ(light.position[0], 256.0f);
    EXPECT_EQ(light.position[2], 768.0f);
    EXPECT_EQ(light.range, 768.0f);
    EXPECT_EQ(light.attenuation[0], 0.5f);
    EXPECT_EQ(light.attenuation[1], 0x1p-10f);
    EXPECT_EQ(light.attenuation[2], 0x1p-19f);
  }
}

// A sun given as a point: its direction and what is left of its light at the scene are right, though the
// square of its distance is no float.
TEST(Flatten, AVeryFarLightIsBroughtNear) {
  scene::Scene s;
  s.spheres = {{.center = dvec3(0), .radius = 1}};
  s.materials.resize(1);
  s.lights = {scene::Light{.position = {3e200, 4e200, 0}, .color = vec3(8)}, lamp(1, {0, 0, 1e30})};
  s.lights[1].range = 1e31;
  s.lights[1].attenuation = {2, 2e-30, 0};
  const FlatScene flat = flatten(s, scene::make_geometry(s), {});
  const layout::Light& sun = flat.lights[0];
  EXPECT_FLOAT_EQ(sun.position[1] / sun.position[0], 4.0f / 3);
  EXPECT_LT(sun.position[1] * sun.position[1], std::numeric_limits<float>::infinity());
  EXPECT_EQ(sun.color[0], 8.0f);
  EXPECT_FLOAT_EQ(flat.lights[1].color[0], 0.25f);
  s.lights[1].range = 9e29;
  EXPECT_EQ(flatten(s, scene::make_geometry(s), {}).lights[1].color[0], 0.0f) << "out of reach";
}

TEST(Flatten, PacksInnerNodesAndLeaves) {
  const scene::Scene s = mixed_scene();
  kdtree::Tree tree = leaf_of_all();
  tree.nodes = {
      {.axis = 1, .split = -0.75f, .left = 1, .right = 2}, {.left = 0, .right = 3}, {.left = 3, .right = 2}};
  const FlatScene flat = flatten(s, scene::make_geometry(s), tree);
  EXPECT_EQ(std::bit_cast<float>(flat.nodes[0].word0), -0.75f);
  EXPECT_EQ(flat.nodes[0].word1, 2u << 2 | 1u);
  EXPECT_EQ(flat.nodes[1].word1, 3u << 2 | KDRAY_NODE_LEAF);
  EXPECT_EQ(flat.nodes[2].word0, 3u);
}

// Below: a leaf; above: groups of two and of one with one more leaf, of two, behind them.
TEST(Flatten, GroupsAreOneLeafOfTheBinaryForm) {
  const scene::Scene s = mixed_scene();
  kdtree::Tree tree = leaf_of_all();
  using kdtree::Node;
  tree.nodes = {{.axis = 0, .split = 1, .left = 1, .right = 6},
                {.axis = 2, .split = 2, .left = 2, .right = 5},
                {.axis = Node::kGroups + 1, .left = 3, .right = 4},
                {.left = 0, .right = 2},
                {.left = 2, .right = 1},
                {.left = 3, .right = 0},
                {.left = 3, .right = 2}};
  const FlatScene flat = flatten(s, scene::make_geometry(s), tree);
  ASSERT_EQ(flat.nodes.size(), 5u);
  EXPECT_EQ(flat.nodes[0].word1, 4u << 2 | 0u);
  EXPECT_EQ(flat.nodes[1].word1, 3u << 2 | 2u);
  EXPECT_EQ(flat.nodes[2].word0, 0u);
  EXPECT_EQ(flat.nodes[2].word1, 3u << 2 | KDRAY_NODE_LEAF);
  EXPECT_EQ(flat.nodes[3].word1, 0u << 2 | KDRAY_NODE_LEAF);
  EXPECT_EQ(flat.nodes[4].word0, 3u);
  EXPECT_EQ(flat.nodes[4].word1, 2u << 2 | KDRAY_NODE_LEAF);
  EXPECT_EQ(flat.refs.size(), 5u);
}

TEST(Flatten, RefusesATreeInAnotherOrder) {
  const scene::Scene s = mixed_scene();
  kdtree::Tree tree = leaf_of_all();
  tree.nodes = {
      {.axis = 0, .split = 0, .left = 2, .right = 1}, {.left = 0, .right = 3}, {.left = 3, .right = 2}};
  EXPECT_THROW((void)flatten(s, scene::make_geometry(s), tree), Error);
}

}  // namespace
}  // namespace kdray::flatten
