// What    What lies at a point of a picture where a mesh is seen several times: which instance, the mesh's
//         primitive, the instance's own material, and where; beside what is no instance.
#include "apps/view/pick.h"

#include <gtest/gtest.h>

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

KDRAY_FOR_EACH_DEVICE(PickTest);

}  // namespace
}  // namespace kdray::view
