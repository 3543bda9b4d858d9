// What    What lies at a point of a picture where a mesh is seen several times: which instance, the mesh's
//         primitive, the instance's own material, and where; beside what is no instance.
#include "apps/view/pick.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/view/facts.h"
#include "scene/model/scene.h"
#include "support/device.h"
#include "support/folder.h"

namespace kdray::view {
namespace {

// Two squares of two triangles beside each other, at heights 0 and 2, the second red; and a sphere behind.
constexpr const char* kScene = R"({
  "camera": {"from": [0, 0, 9], "at": [0, 0, 0]},
  "materials": {"red": {"color": [1, 0, 0]}},
  "objects": [
    {"type": "mesh", "file": "square.obj", "instances": [
      {"translate": [-2, 0, 0]}, {"translate": [2, 0, 2], "material": "red"}]},
    {"type": "sphere", "center": [0, 5, 0], "radius": 1}]})";
constexpr const char* kSquare = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n";

struct PickTest : test::EachDevice {};

TEST_P(PickTest, TellsInstances) {
  const test::Folder folder;
  folder.put("square.obj", kSquare);
  LoadOptions options;
  options.instances = Instances::kept;
  const PreparedScene scene(Scene::load(folder.put("scene.json", kScene), options));
  Picker picker(scene, {{"", 0, 1}}, {.device = GetParam()});
  const auto first = picker.pick({{-2.5, 0.5, 9}, {0, 0, -1}});
  ASSERT_TRUE(first && first->instance);
  EXPECT_EQ(first->kind, "instance");
  EXPECT_EQ(*first->instance, 0u);
  EXPECT_EQ(first->primitive, 1u);
  EXPECT_NEAR(first->distance, 9, 1e-4);
  EXPECT_FALSE(first->material);
  const auto second = picker.pick({{2.5, -0.5, 9}, {0, 0, -1}});
  ASSERT_TRUE(second && second->instance);
  EXPECT_EQ(*second->instance, 1u);
  EXPECT_EQ(second->primitive, 0u);
  EXPECT_NEAR(second->point[2], 2, 1e-4);
  ASSERT_TRUE(second->material);
  EXPECT_EQ(scene.settings().materials[*second->material].diffuse.y, 0);
  const auto sphere = picker.pick({{0, 5, 9}, {0, 0, -1}});
  ASSERT_TRUE(sphere);
  EXPECT_FALSE(sphere->instance);
  EXPECT_EQ(sphere->kind, "sphere");
  EXPECT_FALSE(picker.pick({{0, 0, 9}, {0, 0, -1}}));
}

TEST_P(PickTest, NamesPartsAndMaterials) {
  const test::Folder folder;
  const auto file = folder.put(
      "a.obj",
      "o left\nv -1 0 0\nv 0 0 0\nv -1 1 0\nusemtl brass\nf 1 2 3\no right\nv 1 0 0\nv 0 1 0\nf 2 4 5\n");
  const PreparedScene scene(Scene::load(file));
  Picker picker(scene, {{"", 0, 2}}, {.device = GetParam()});
  const auto left = picker.pick({{-0.75, 0.25, 9}, {0, 0, -1}}),
             right = picker.pick({{0.25, 0.25, 9}, {0, 0, -1}});
  ASSERT_TRUE(left && right);
  EXPECT_EQ(left->part, "left");
  EXPECT_EQ(right->part, "right");
  const auto message = nlohmann::json::parse(picked_message(0, right, scene));
  EXPECT_EQ(message["part"], "right");
  EXPECT_EQ(message["material"]["name"], "brass");
}

KDRAY_FOR_EACH_DEVICE(PickTest);

}  // namespace
}  // namespace kdray::view
