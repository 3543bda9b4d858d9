// What    No command overwrites a file that its run reads or that the scene names, or writes one file twice;
//         names that are given by default step aside.
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "scene/gltf_samples.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kMine = "the user's own file";
constexpr const char* kTriangle =
    "ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 3\nproperty float x\n"
    "property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
constexpr const char* kMeshScene = R"({"objects": [{"type": "mesh", "file": "mesh.ply"}]})";

// One triangle, and a texture that no material of it uses.
std::string gltf_with_picture(const std::string& uri) {
  GltfSample sample;
  const int positions = sample.vectors({0, 0, 0, 1, 0, 0, 0, 1, 0});
  sample.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}}}}}};
  sample.json["images"] = {{{"uri", uri}}};
  return sample.json.dump();
}

struct FilesTest : testing::Test {
  Folder folder;
  Outcome run(const std::vector<std::string>& arguments) const {
    return kdray(arguments, {.folder = folder.path()});
  }
  // Refused as two names of one file, which is as it was.
  testing::AssertionResult keeps(const std::string& file, const std::vector<std::string>& arguments) const {
    const std::string before = folder.get(file);
    const testing::AssertionResult refused = fails_with(run(arguments), 2, "same file");
    if (!refused) return refused;
    if (folder.get(file) != before) return testing::AssertionFailure() << file << " has changed";
    return testing::AssertionSuccess();
  }
};

TEST_F(FilesTest, TheDefaultPictureStepsAsideFromATexture) {
  KDRAY_NEED_DEVICE();
  folder.put("Milk Truck.gltf", gltf_with_picture("Milk%20Truck.png"));
  folder.put("Milk Truck.png", kMine);
  const Outcome aside = run({"render", "Milk Truck.gltf", "--size", "8x8"});
  ASSERT_TRUE(succeeds(aside));
  EXPECT_NE(aside.err.find("the picture goes to Milk Truck.kdray.png"), std::string::npos) << aside.err;
  EXPECT_EQ(folder.get("Milk Truck.png"), kMine);
  EXPECT_EQ(folder.get("Milk Truck.kdray.png").substr(1, 3), "PNG");
  EXPECT_TRUE(keeps("Milk Truck.png", {"render", "Milk Truck.gltf", "-o", "Milk Truck.png"}));
}

TEST_F(FilesTest, TheDefaultPictureStepsAsideFromAnotherOutput) {
  KDRAY_NEED_DEVICE();
  folder.put("ball.nff", kSphereOnSquare);
  ASSERT_TRUE(succeeds(run({"render", "ball.nff", "--stats", "ball.png", "--size", "8x8"})));
  EXPECT_EQ(Json::parse(folder.get("ball.png"))["files"][0], "ball.kdray.png");
}

TEST_F(FilesTest, MeshesOfASceneAreKept) {
  folder.put("scene.json", kMeshScene);
  folder.put("mesh.ply", kTriangle);
  fs::create_directory(folder / "below");
  fs::create_symlink(folder / "mesh.ply", folder / "link.json");
  fs::create_hard_link(folder / "mesh.ply", folder / "hard.json");
  for (const char* const name : {"mesh.ply", "./mesh.ply", "below/../mesh.ply", "link.json", "hard.json"})
    EXPECT_TRUE(keeps("mesh.ply", {"render", "scene.json", "-o", "a.png", "--stats", name})) << name;
  EXPECT_TRUE(keeps("mesh.ply", {"render", "scene.json", "-o", "a.png", "--trace", "mesh.ply"}));
  EXPECT_TRUE(keeps("mesh.ply", {"verify", "scene.json", "--stats", "mesh.ply"}));
  EXPECT_TRUE(keeps("mesh.ply", {"tune", "scene.json", "-o", "t.json", "--stats", "mesh.ply"}));
  EXPECT_TRUE(keeps("scene.json", {"render", "scene.json", "-o", "a.png", "--stats", "scene.json"}));
  EXPECT_TRUE(keeps("scene.json", {"tune", "scene.json", "-o", "scene.json"}));
  EXPECT_FALSE(fs::exists(folder / "a.png"));
}

TEST_F(FilesTest, TexturesAreKeptThatAreNotRead) {
  folder.put("model.obj", "mtllib model.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.put("model.mtl",
             "newmtl a\nmap_Kd -s 1 1 1 two words.png\nmap_Bump C:\\art\\bump.png\nnorm ./normal.png\n");
  folder.put("scan.ply", kTriangle);
  folder.put("deep.gltf", gltf_with_picture("textures/../colour.png"));
  for (const char* const file : {"two words.png", "bump.png", "normal.png"}) {
    folder.put(file, kMine);
    EXPECT_TRUE(keeps(file, {"render", "model.obj", "-o", file})) << file;
  }
  folder.put("skin.png", kMine);
  EXPECT_TRUE(keeps("skin.png", {"verify", "scan.ply", "-o", "skin.png"}));
  folder.put("colour.png", kMine);
  EXPECT_FALSE(fails_with(run({"render", "deep.gltf", "-o", "colour.png"}), 0, ""));
  EXPECT_TRUE(keeps("model.mtl", {"render", "model.obj", "-o", "a.png", "--stats", "model.mtl"}));
}

TEST_F(FilesTest, AFileIsNotWrittenTwice) {
  folder.put("ball.nff", kSphereOnSquare);
  EXPECT_TRUE(
      keeps("z.png", {"render", "ball.nff", "--aov", "depth", "-o", "z.png", "--stats", "z.depth.png"}));
  EXPECT_TRUE(keeps("z.png", {"render", "ball.nff", "-o", "z.png", "--stats", "Z.PNG"}));
  EXPECT_TRUE(keeps("z.png", {"render", "ball.nff", "-o", "z.png", "--trace", "./z.png"}));
  fs::create_symlink("not yet.png", folder / "link.png");
  EXPECT_TRUE(keeps("z.png", {"render", "ball.nff", "-o", "link.png", "--stats", "not yet.png"}));
  EXPECT_TRUE(fails_with(run({"render", "ball.nff", "-o", "-", "--stats", "-"}), 2, "standard output"));
  EXPECT_EQ(folder.n_entries(), 2u);
}

TEST_F(FilesTest, NamesThatDifferInCapitalsAreTwoFilesWhereTheyAreThere) {
  KDRAY_NEED_DEVICE();
  folder.put("ball.nff", kSphereOnSquare);
  folder.put("Ball.png", ""), folder.put("ball.PNG", "");
  if (folder.n_entries() != 3) GTEST_SKIP() << "this file system doesn't tell them apart";
  EXPECT_TRUE(
      succeeds(run({"render", "ball.nff", "-o", "Ball.png", "--stats", "ball.PNG", "--size", "8x8"})));
}

// The scene does not exist: a message about it would mean that it was looked for first.
TEST_F(FilesTest, AChannelsPictureThatCannotBeWrittenIsRefusedFirst) {
  fs::create_directory(folder / "z.depth.png");
  EXPECT_TRUE(fails_with(run({"render", "none.nff", "-o", "z.png", "--aov", "depth"}), 1, "z.depth.png"));
  EXPECT_TRUE(fails_with(run({"render", "none.nff", "-o", ""}), 2, "--output"));
}

TEST_F(FilesTest, ARepeatedRunFromTheCacheKeepsThem) {
  KDRAY_NEED_DEVICE();
  // Large enough to be kept.
  ASSERT_TRUE(succeeds(run({"generate", "balls", "--size", "5", "-o", "balls.nff"})));
  folder.put("scene.json", R"({"objects": [{"type": "mesh", "file": "balls.nff"}]})");
  const std::vector<std::string> render = {"render", "scene.json", "-o",   "a.png",  "--size",
                                           "8x8",    "--cache",    "kept", "--stats"};
  const auto with_stats = [&](const char* file) {
    std::vector<std::string> arguments = render;
    arguments.push_back(file);
    return arguments;
  };
  ASSERT_TRUE(succeeds(run(with_stats("s.json"))));
  ASSERT_TRUE(succeeds(run(with_stats("s.json"))));
  ASSERT_EQ(Json::parse(folder.get("s.json"))["cache"], "hit");
  EXPECT_TRUE(keeps("balls.nff", with_stats("balls.nff")));
}

}  // namespace
}  // namespace kdray::test
