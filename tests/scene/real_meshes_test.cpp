// What    Every mesh of the test data loads, with as many triangles as its list of sources counted in it with
//         other software.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "base/error.h"
#include "scene/import/files.h"
#include "scene/import/load.h"
#include "support/data.h"

namespace kdray::scene {
namespace {

// The triangle counts of SOURCES.md, by the unpacked file's name.
std::map<std::string, std::size_t> read_counts() {
  std::ifstream in(test::data_path("SOURCES.md"));
  std::map<std::string, std::size_t> counts;
  std::string name;
  for (std::string line; std::getline(in, line);) {
    const std::size_t end = line.find("**", 4);
    if (line.starts_with("- **") && end != std::string::npos) name = line.substr(4, end - 4);
    const std::size_t stats = line.find("- stats: ");
    if (stats == std::string::npos || line.find(" tris,") == std::string::npos) continue;
    counts[name] = std::stoull(line.substr(stats + 9));
  }
  return counts;
}

void expect_loads(const std::string& folder, std::size_t least_files) {
  const auto counts = read_counts();
  std::size_t n_files = 0;
  constexpr std::array<std::string_view, 5> kEndings = {".ply", ".obj", ".stl", ".gltf", ".glb"};
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test::data_path(folder))) {
    if (std::ranges::find(kEndings, format_of(entry.path())) == kEndings.end()) continue;
    std::filesystem::path name = entry.path().lexically_relative(test::data_path(""));
    if (name.extension() == ".xz") name.replace_extension();
    ++n_files;
    try {
      const Scene scene = load(entry.path());
      const auto count = counts.find(name.generic_string());
      if (count != counts.end()) {
        EXPECT_EQ(scene.triangles.size(), count->second) << name;
      }
    } catch (const Error& e) {
      const bool packed = std::string(e.what()).find("libdraco-dev") != std::string::npos;
      EXPECT_TRUE(packed) << e.what();
    }
  }
  EXPECT_GE(n_files, least_files);
}

TEST(RealMeshes, OfTheStanfordFolderLoad) {
  KDRAY_NEED_DATA(test::data_path("stanford"));
  expect_loads("stanford", 17);
}

TEST(RealMeshes, OfTheInteriorFolderLoad) {
  KDRAY_NEED_DATA(test::data_path("interior"));
  expect_loads("interior", 20);
}

TEST(RealMeshes, OfTheGltfFolderLoad) {
  KDRAY_NEED_DATA(test::data_path("gltf"));
  expect_loads("gltf", 50);
}

TEST(RealMeshes, AFewCountsWithoutTheList) {
  const std::map<std::string, std::size_t> counts = {
      {"stanford/dragon_vrip.ply.xz", 871414},
      {"stanford/bunny_zipper_ascii.ply.xz", 69451},
      {"stanford/cow.obj.xz", 5804},
      {"stanford/suzanne.obj", 968},
      {"interior/cornell/CornellBox-Original.obj", 36},
      {"gltf/DamagedHelmet.glb", 15452},
      {"gltf/SimpleSparseAccessor/SimpleSparseAccessor.gltf", 12},
      {"gltf/trimesh/mode5.gltf", 2786}};
  for (const auto& [name, count] : counts) {
    const auto file = test::data_path(name);
    KDRAY_NEED_DATA(file);
    EXPECT_EQ(load(file).triangles.size(), count) << name;
  }
}

// Its five pictures say what it is like; where they have nothing to say it is no mirror and no lamp.
TEST(RealMeshes, TheDamagedHelmetCanBeSeen) {
  const auto file = test::data_path("gltf/DamagedHelmet.glb");
  KDRAY_NEED_DATA(file);
  const Scene s = load(file);
  ASSERT_EQ(s.materials.size(), 1u);
  ASSERT_LT(s.materials[0].maps, s.texturing.material_maps.size());
  const MaterialMaps& maps = s.texturing.material_maps[s.materials[0].maps];
  EXPECT_GT(largest_terms(maps).diffuse.y, 0.5f);
  ASSERT_EQ(s.texturing.pictures.size(), 5u);  // JPEGs in the file itself
  for (const std::uint32_t map : {maps.metal_map, maps.normal_map, maps.emission_map, maps.occlusion_map})
    EXPECT_LT(map, s.texturing.textures.size());
  EXPECT_EQ(s.texturing.pictures[0]->width, 2048u);
  EXPECT_EQ(s.texturing.texcoords[0].size(), s.triangles.size());
  EXPECT_EQ(s.materials[0].reflect, vec3(0));
  EXPECT_EQ(s.materials[0].emission, vec3(0));
  EXPECT_NE(s.triangles[0].normal[0], kNone);
}

}  // namespace
}  // namespace kdray::scene
