// What    The built-in scenes are as large as a bench says they are, and whole.
#include "scene/generate/built_in.h"

#include <gtest/gtest.h>

#include "scene/model/check_scene.h"
#include "support/errors.h"

namespace kdray::generate {
namespace {

TEST(Scenes, BoxesAndSpheres) {
  for (const auto& [name, triangles] : {std::pair{"boxes", 307572u}, std::pair{"spheres", 897800u}}) {
    const scene::Scene s = load_scene(name);
    EXPECT_EQ(s.name, name);
    EXPECT_EQ(s.triangles.size(), triangles);
    EXPECT_TRUE(s.camera && !s.lights.empty());
    EXPECT_NO_THROW(scene::check_scene(s));
  }
}

TEST(Scenes, ADisplacedSphereOfAMillion) {
  const scene::Scene s = load_scene("displaced");
  EXPECT_GE(s.triangles.size(), 1000000u);
  EXPECT_LE(s.triangles.size(), 1010000u);
  EXPECT_TRUE(s.camera && !s.lights.empty());
  EXPECT_NO_THROW(scene::check_scene(s));
}

TEST(Scenes, OfTheGeneratorsByName) {
  const scene::Scene rings = load_scene("rings");
  EXPECT_EQ(rings.spheres.size(), 4200u);
  EXPECT_EQ(rings.cones.size(), 4200u);
  EXPECT_TRUE(rings.camera && !rings.lights.empty());
}

TEST(Scenes, AnotherNameIsAFile) {
  EXPECT_TRUE(test::fails([] { load_scene("nosuch"); }, "nosuch"));
  EXPECT_TRUE(test::fails([] { load_scene("nosuch"); }, "boxes spheres displaced lamps balls"));
}

}  // namespace
}  // namespace kdray::generate
