// What    Every scene that comes with kdray loads without a warning, renders by itself (camera, lights) and
//         is small.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <vector>

#include "nff_lines.h"
#include "scene/import/files.h"
#include "scene/import/load.h"
#include "scene/model/geometry.h"
#include "support/data.h"

namespace kdray::scene {
namespace {

std::vector<std::filesystem::path> scene_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(test::source_path("scenes"))) {
    const std::string ending = entry.path().extension().string();
    if (entry.is_regular_file() && ending != ".md") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

TEST(Scenes, LoadWithoutWarnings) {
  const auto files = scene_files();
  ASSERT_GE(files.size(), 5u);
  for (const auto& file : files) {
    SCOPED_TRACE(file.filename());
    const Scene s = load(file);
    EXPECT_TRUE(s.warnings.empty()) << s.warnings.front();
    EXPECT_TRUE(s.camera.has_value());
    EXPECT_FALSE(s.lights.empty());
    EXPECT_EQ(make_geometry(s).dropped_degenerate, 0u);
  }
}

TEST(Scenes, AreSmall) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test::source_path("scenes"))) {
    if (!entry.is_regular_file()) continue;
    EXPECT_LT(entry.file_size(), 100'000u) << entry.path();
  }
}

TEST(Scenes, NffFilesAreAsGenerated) {
  EXPECT_EQ(read_file(test::source_path("scenes/balls.nff")), test::generated("balls", 3));
  EXPECT_EQ(read_file(test::source_path("scenes/tree.nff")), test::generated("tree", 7));
}

// materials.json is what the pictures of kdray are held against an independent ray tracer with: it must keep
// on having one of everything.
TEST(Scenes, MaterialsHasOneOfEverything) {
  const Scene s = load(test::source_path("scenes/materials.json"));
  std::set<LightKind> lights;
  bool attenuated = false, ranged = false, soft_spot = false;
  for (const Light& l : s.lights) {
    lights.insert(l.kind);
    attenuated |= l.attenuation != dvec3(1, 0, 0);
    ranged |= std::isfinite(l.range);
    soft_spot |= l.kind == LightKind::spot && l.cos_inner > l.cos_outer;
  }
  EXPECT_EQ(lights.size(), 3u);
  EXPECT_TRUE(attenuated && ranged && soft_spot);
  const auto any_material = [&](auto predicate) { return std::ranges::any_of(s.materials, predicate); };
  EXPECT_TRUE(any_material([](const Material& m) { return m.emission != vec3(0); }));
  EXPECT_TRUE(any_material([](const Material& m) { return m.specular != vec3(0) && m.reflect == vec3(0); }));
  EXPECT_TRUE(any_material([](const Material& m) { return m.reflect != vec3(0); }));
  EXPECT_TRUE(
      any_material([](const Material& m) { return m.transmit.x > 0 && m.transmit.x == m.transmit.z; }));
  EXPECT_TRUE(
      any_material([](const Material& m) { return m.transmit != vec3(0) && m.transmit.x != m.transmit.z; }));
  const auto smooth = [](const Triangle& t) { return t.normal[0] != kNone; };
  EXPECT_TRUE(std::ranges::any_of(s.triangles, smooth));
  EXPECT_FALSE(std::ranges::all_of(s.triangles, smooth));
  EXPECT_FALSE(s.spheres.empty());
  EXPECT_TRUE(std::ranges::any_of(s.cones, [](const Cone& c) { return c.base_radius == c.apex_radius; }));
  EXPECT_TRUE(std::ranges::any_of(s.cones, [](const Cone& c) { return c.base_radius != c.apex_radius; }));
  EXPECT_TRUE(std::ranges::any_of(s.cones, [](const Cone& c) { return c.apex_radius == 0; }));
  EXPECT_LT(s.triangles.size(), 500u);
}

}  // namespace
}  // namespace kdray::scene
