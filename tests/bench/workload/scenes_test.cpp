// What    Benches' scenes by name: what stands in the meadow, spheres of so many triangles, rooms and scans
//         out of the folder of data, and what is refused before anything is measured.
#include "bench/workload/scenes.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "base/error.h"
#include "support/data.h"
#include "support/folder.h"

namespace kdray::bench {
namespace {

class BenchScenes : public testing::Test {
 protected:
  void SetUp() override { unsetenv("KDRAY_DATA"); }
  void TearDown() override { unsetenv("KDRAY_DATA"); }
};

std::string refusal_of(const std::string& name) {
  try {
    require_scene(name);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input);
    return e.what();
  }
  return "";
}

TEST_F(BenchScenes, PlantsStandOnTheMeadowsGround) {
  const scene::Scene s = load_scene("meadow");
  ASSERT_EQ(s.meshes.size(), 3u);
  EXPECT_EQ(s.triangles.size(), 20000u);
  EXPECT_EQ(s.instances.size(), 3460u);
  std::size_t seen = s.triangles.size();
  for (const scene::Instance& i : s.instances) seen += s.meshes[i.mesh]->triangles.size();
  EXPECT_GT(seen, 2000000u);
  for (const auto& mesh : s.meshes)
    for (const scene::Triangle& t : mesh->triangles) ASSERT_LT(t.material, s.materials.size());
  const DBox ground = s.bounds();
  for (const scene::Instance& i : s.instances) {
    EXPECT_LT(std::abs(i.move.x), 40);
    EXPECT_LT(std::abs(i.move.y), 1);
  }
  EXPECT_GE(ground.hi.y, 0.5);
  EXPECT_EQ(load_scene("meadow").instances.back().move, s.instances.back().move);
}

TEST_F(BenchScenes, SpheresHaveTheTrianglesThatTheirNameAsksFor) {
  const scene::Scene s = load_scene("displaced:50000");
  EXPECT_GE(s.triangles.size(), 50000u);
  EXPECT_LT(s.triangles.size(), 52000u);
  EXPECT_TRUE(s.camera.has_value());
  for (const char* const name :
       {"displaced:", "displaced:99", "displaced:5e4", "displaced:-200", "displaced:100000001"})
    EXPECT_NE(refusal_of(name).find("a number of triangles"), std::string::npos) << name;
}

TEST_F(BenchScenes, DataAreSoughtWhereTheVariableSays) {
  EXPECT_TRUE(data_scenes().here.empty());
  EXPECT_EQ(data_scenes().missing.size(), 4u);
  const test::Folder folder;
  std::filesystem::create_directory(folder.path() / "stanford");
  folder.put("stanford/armadillo_86k.ply.xz", "");
  setenv("KDRAY_DATA", folder.path().c_str(), 1);
  EXPECT_EQ(data_scenes().here, std::vector<std::string>{"armadillo"});
  EXPECT_EQ(refusal_of("armadillo"), "");
  EXPECT_NE(refusal_of("sponza").find("interior/dabrovic_sponza"), std::string::npos);
}

TEST_F(BenchScenes, RoomsAreSeenFromWithin) {
  KDRAY_NEED_DATA(test::data_path("interior"));
  setenv("KDRAY_DATA", test::data_path("").c_str(), 1);
  for (const char* const name : {"sponza", "conference"}) {
    const scene::Scene s = load_scene(name);
    const DBox box = s.bounds();
    for (const dvec3& p : {s.camera->from, s.lights.at(0).position})
      EXPECT_TRUE(glm::all(glm::lessThan(box.lo, p)) && glm::all(glm::lessThan(p, box.hi))) << name;
  }
}

TEST_F(BenchScenes, ANameThatIsNothingIsRefused) {
  EXPECT_NE(refusal_of("medow").find("neither a file nor"), std::string::npos);
}

}  // namespace
}  // namespace kdray::bench
