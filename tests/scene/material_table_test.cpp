#include "scene/import/materials.h"

#include <gtest/gtest.h>

namespace kdray::scene {
namespace {

TEST(MaterialTable, GivesEqualMaterialsOneNumber) {
  std::vector<Material> materials{Material{.diffuse = vec3(1)}};
  MaterialTable table(materials);
  Material red{.diffuse = vec3(1, 0, 0)};
  Material shiny = red;
  shiny.shine = 20;
  EXPECT_EQ(table.add(Material{.diffuse = vec3(1)}), 0u);
  EXPECT_EQ(table.add(red), 1u);
  EXPECT_EQ(table.add(shiny), 2u);
  EXPECT_EQ(table.add(red), 1u);
  Material minus_zero = red;
  minus_zero.diffuse.y = -0.0f;  // equal to red, so it must also hash alike
  EXPECT_EQ(table.add(minus_zero), 1u);
  EXPECT_EQ(materials.size(), 3u);
  EXPECT_EQ(materials[2], shiny);
}

}  // namespace
}  // namespace kdray::scene
