// What is found in the cache, and when not: changed, vanished and appearing files, options, limits, several
// at once.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "accel/cache/cache.h"
#include "accel/cache/entry.h"
#include "accel/cache/samples.h"
#include "support/errors.h"

namespace kdray::cache {
namespace {

constexpr const char* kSquare = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";
constexpr const char* kFaces = "usemtl red\nf 1 2 3\nf 1 3 4\n";
constexpr const char* kRed = "newmtl red\nKd 1 0 0\n";
constexpr const char* kGreen = "newmtl red\nKd 0 1 0\n";

struct FindTest : testing::Test {
  test::Folder folder;
  CacheOptions cache = test::all_kept_in(folder / "cache");

  prepare::Prepared keep_it(const std::filesystem::path& file, const TreeOptions& tree = {},
                            const LoadOptions& load = {}) {
    prepare::Prepared made = test::prepared_from(file, tree, load);
    EXPECT_TRUE(keep(cache, made));
    return made;
  }
  std::size_t n_kept() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(cache.folder), {}));
  }
};

TEST_F(FindTest, FindsWhatWasKept) {
  const auto file = folder.put("balls.nff", test::nff("balls", 2));
  EXPECT_FALSE(find(cache, file, {}));
  const prepare::Prepared made = keep_it(file);
  const std::optional<prepare::Prepared> found = find(cache, file, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(test::everything(*found), test::everything(made));
  EXPECT_EQ(n_kept(), 1u);
}

TEST_F(FindTest, ChangedSceneIsNotFound) {
  const auto file = folder.put("balls.nff", test::nff("balls", 1));
  keep_it(file);
  folder.put("balls.nff", test::nff("balls", 1) + "s 0 0 0 2\n");
  EXPECT_FALSE(find(cache, file, {}));
  folder.put("balls.nff", test::nff("balls", 1));
  EXPECT_TRUE(find(cache, file, {}));
  std::filesystem::remove(file);
  EXPECT_FALSE(find(cache, file, {}));
}

TEST_F(FindTest, OtherTreeOptionsAreOtherEntries) {
  const auto file = folder.put("balls.nff", test::nff("balls", 1));
  const TreeOptions flat{.max_depth = 2};
  keep_it(file);
  EXPECT_FALSE(find(cache, file, flat));
  const prepare::Prepared made = keep_it(file, flat);
  EXPECT_EQ(test::everything(*find(cache, file, flat)), test::everything(made));
  EXPECT_EQ(n_kept(), 2u);
}

TEST_F(FindTest, OtherLoadOptionsAreOtherEntries) {
  const auto file = folder.put("square.obj", std::string(kSquare) + "f 1 2 3\nf 1 3 4\n");
  const LoadOptions smooth{.smooth_degrees = 30};
  keep_it(file);
  EXPECT_FALSE(find(cache, file, {}, smooth));
  const prepare::Prepared made = keep_it(file, {}, smooth);
  EXPECT_EQ(test::everything(*find(cache, file, {}, smooth)), test::everything(made));
  EXPECT_NE(test::everything(*find(cache, file, {})), test::everything(made));
  EXPECT_EQ(find(cache, file, {}, smooth)->settings.load_options, smooth);
  EXPECT_EQ(n_kept(), 2u);
}

TEST_F(FindTest, MovedAndRenamedSceneIsFound) {
  const prepare::Prepared made = keep_it(folder.put("balls.nff", test::nff("balls", 1)));
  std::filesystem::create_directory(folder / "there");
  std::filesystem::rename(folder / "balls.nff", folder / "there/b.nff");
  const std::optional<prepare::Prepared> found = find(cache, folder / "there/b.nff", {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->settings.name, (folder / "there/b.nff").string());
  std::filesystem::rename(folder / "there/b.nff", folder / "there/b.obj");
  EXPECT_FALSE(find(cache, folder / "there/b.obj", {})) << "the same bytes in another format";
}

// Whoever waits for the scene to change looks at the file that was asked for.
TEST_F(FindTest, ARenamedSceneIsItsOwnFile) {
  const auto file = folder.put("balls.nff", test::nff("balls", 1));
  keep_it(file);
  const auto copy = folder.put("copy.nff", test::nff("balls", 1));
  const std::optional<prepare::Prepared> found = find(cache, copy, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->settings.files.front().path, copy);
}

TEST_F(FindTest, ChangedMaterialFileIsNoticed) {
  folder.put("m.mtl", kRed);
  const auto file = folder.put("square.obj", std::string("mtllib m.mtl\n") + kSquare + kFaces);
  keep_it(file);
  ASSERT_TRUE(find(cache, file, {}));
  folder.put("m.mtl", kGreen);
  EXPECT_FALSE(find(cache, file, {}));
  EXPECT_EQ(keep_it(file).settings.materials.at(0).diffuse, vec3(0, 1, 0));
  EXPECT_EQ(find(cache, file, {})->settings.materials.at(0).diffuse, vec3(0, 1, 0));
  std::filesystem::remove(folder / "m.mtl");
  EXPECT_FALSE(find(cache, file, {}));
}

TEST_F(FindTest, AppearingMaterialFileIsNoticed) {
  const auto file = folder.put("square.obj", std::string("mtllib m.mtl\n") + kSquare + kFaces);
  keep_it(file);
  ASSERT_TRUE(find(cache, file, {}));
  EXPECT_FALSE(find(cache, folder / "." / "square.obj", {})) << "its warning names the file in other words";
  folder.put("m.mtl", kRed);
  EXPECT_FALSE(find(cache, file, {}));
}

TEST_F(FindTest, ChangedMeshOfAJsonSceneIsNoticed) {
  std::filesystem::create_directory(folder / "meshes");
  folder.put("meshes/m.mtl", kRed);
  folder.put("meshes/square.obj", std::string("mtllib m.mtl\n") + kSquare + kFaces);
  const auto file =
      folder.put("scene.json", R"({"objects": [{"type": "mesh", "file": "meshes/square.obj"}]})");
  keep_it(file);
  ASSERT_TRUE(find(cache, file, {}));
  folder.put("meshes/m.mtl", kGreen);
  EXPECT_FALSE(find(cache, file, {}));
  folder.put("meshes/m.mtl", kRed);
  ASSERT_TRUE(find(cache, file, {}));
  folder.put("meshes/square.obj", std::string("mtllib m.mtl\n") + kSquare + "usemtl red\nf 1 2 3\n");
  EXPECT_FALSE(find(cache, file, {}));
  std::filesystem::remove(folder / "meshes/square.obj");
  EXPECT_FALSE(find(cache, file, {}));
}

// The files beside the scene that is asked for count, not those beside the one that was kept.
TEST_F(FindTest, CopiedSceneLooksAtItsOwnFiles) {
  folder.put("m.mtl", kRed);
  const std::string square = std::string("mtllib m.mtl\n") + kSquare + kFaces;
  keep_it(folder.put("square.obj", square));
  std::filesystem::create_directory(folder / "copy");
  folder.put("copy/square.obj", square);
  EXPECT_FALSE(find(cache, folder / "copy/square.obj", {}));
  folder.put("copy/m.mtl", kGreen);
  EXPECT_FALSE(find(cache, folder / "copy/square.obj", {}));
  folder.put("copy/m.mtl", kRed);
  EXPECT_TRUE(find(cache, folder / "copy/square.obj", {}));
}

TEST_F(FindTest, ChangedBufferOfAGltfSceneIsNoticed) {
  const auto buffer = [](float x) {
    const float v[9] = {0, 0, 0, x, 0, 0, 0, 1, 0};
    return std::string(reinterpret_cast<const char*>(v), sizeof v);
  };
  folder.put("b.bin", buffer(1));
  const auto file =
      folder.put("t.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
      "buffers": [{"uri": "b.bin", "byteLength": 36}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                     "min": [0, 0, 0], "max": [2, 1, 0]}]})");
  keep_it(file);
  ASSERT_TRUE(find(cache, file, {}));
  folder.put("b.bin", buffer(2));
  EXPECT_FALSE(find(cache, file, {}));
}

TEST_F(FindTest, DamagedEntryIsReplaced) {
  const auto file = folder.put("balls.nff", test::nff("balls", 1));
  keep_it(file);
  const std::filesystem::path entry = std::filesystem::directory_iterator(cache.folder)->path();
  for (const std::uintmax_t n : {std::uintmax_t{0}, std::filesystem::file_size(entry) / 2}) {
    std::filesystem::resize_file(entry, n);
    EXPECT_FALSE(find(cache, file, {}));
    keep_it(file);
    EXPECT_TRUE(find(cache, file, {}));
  }
  EXPECT_EQ(n_kept(), 1u);
}

TEST_F(FindTest, WithoutAFolderThereIsNoCache) {
  const auto file = folder.put("balls.nff", test::nff("balls", 1));
  EXPECT_FALSE(keep({}, test::prepared_from(file)));
  EXPECT_FALSE(find({}, file, {}));
}

TEST_F(FindTest, WhatIsNotWorthItIsNotKept) {
  const prepare::Prepared made = test::prepared_from(folder.put("balls.nff", test::nff("balls", 1)));
  CacheOptions large = cache, small = cache;
  large.min_bytes = entry_bytes(made) + 1;
  EXPECT_FALSE(keep(large, made)) << "too small";
  small.max_bytes = 4 * entry_bytes(made) - 1;
  EXPECT_FALSE(keep(small, made)) << "over a quarter of the bound";
  EXPECT_FALSE(exists(cache.folder));
  small.max_bytes += 1;
  small.min_bytes = entry_bytes(made);
  EXPECT_TRUE(keep(small, made));
  prepare::Prepared from_nowhere = made;
  from_nowhere.settings.files.clear();
  EXPECT_FALSE(keep(cache, from_nowhere));
}

TEST_F(FindTest, TheFolderStaysWithinItsBound) {
  std::vector<std::filesystem::path> files;
  for (int i = 0; i < 6; ++i)
    files.push_back(folder.put("balls" + std::to_string(i) + ".nff",
                               test::nff("balls", 1) + "s 0 0 " + std::to_string(i) + " 1\n"));
  cache.max_bytes = 4 * entry_bytes(test::prepared_from(files[0])) + 4096;
  std::filesystem::create_directory(folder / "cache");
  for (const auto& file : files) {
    // File times may be coarse: what is there becomes older by a second.
    for (const auto& entry : std::filesystem::directory_iterator(folder / "cache"))
      last_write_time(entry, last_write_time(entry) - std::chrono::seconds(1));
    keep_it(file);
    find(cache, files[0], {});  // used again and again: it stays
  }
  EXPECT_EQ(n_kept(), 4u);
  EXPECT_TRUE(find(cache, files[0], {}));
  EXPECT_FALSE(find(cache, files[1], {}));
  EXPECT_TRUE(find(cache, files[5], {}));
}

TEST_F(FindTest, AFolderThatCannotBeMadeIsAnInputError) {
  folder.put("cache", "a file");
  const prepare::Prepared made = test::prepared_from(folder.put("balls.nff", test::nff("balls", 1)));
  EXPECT_TRUE(test::fails([&] { keep(cache, made); }, "cache"));
  cache.folder = folder / "cache/below";
  EXPECT_TRUE(test::fails([&] { keep(cache, made); }, "cache"));
  EXPECT_FALSE(find(cache, folder / "balls.nff", {}));
}

// Whoever reads finds a whole entry or none, while others write it and a folder too small for both scenes is
// cleared.
TEST_F(FindTest, SeveralAtOnce) {
  const auto a = folder.put("a.nff", test::nff("balls", 1)), b = folder.put("b.nff", test::nff("tetra", 3));
  const prepare::Prepared made[2] = {test::prepared_from(a), test::prepared_from(b)};
  const std::string wanted[2] = {test::everything(made[0]), test::everything(made[1])};
  cache.max_bytes = 4 * std::max(entry_bytes(made[0]), entry_bytes(made[1]));
  const std::filesystem::path file[2] = {a, b};
  std::atomic<int> n_found = 0, n_wrong = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&, t] {
        for (int i = 0; i < 50; ++i) {
          const int which = (t + i) % 2;
          if (t < 2) keep(cache, made[which]);
          const auto found = find(cache, file[which], {});
          n_found += found.has_value();
          n_wrong += found && test::everything(*found) != wanted[which];
        }
      });
  }
  EXPECT_GT(n_found, 50);
  EXPECT_EQ(n_wrong, 0);
  EXPECT_LE(n_kept(), 2u) << "temporary files are left";
}

}  // namespace
}  // namespace kdray::cache
