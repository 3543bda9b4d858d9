// What    --smooth against the same angle in a JSON scene; scene/smooth_normals_test.cpp checks the normals.
#include "apps/cli/program.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

// A tent of two faces, which turn by 53 degrees at its ridge.
constexpr const char* kTent =
    "v -2 -1 0\nv -2 1 0\nv 0 1 1\nv 0 -1 1\nv 2 -1 0\nv 2 1 0\nf 1 4 3 2\nf 4 5 6 3\n";

std::string scene_of_tent(const std::string& more) {
  return R"({"camera": {"from": [1, -4, 6], "at": [0, 0, 0], "up": [0, 0, 1]},
             "objects": [{"type": "mesh", "file": "tent.obj")" +
         more + "}]}";
}

struct SmoothTest : testing::Test {
  Folder folder;
  void SetUp() override {
    folder.put("tent.obj", kTent);
    folder.put("flat.json", scene_of_tent(""));
    folder.put("smooth.json", scene_of_tent(R"(, "smooth": 60)"));
  }
  std::string picture(const std::string& scene, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"render", folder / scene, "-o", "-", "-q", "--size", "48x48"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = kdray(arguments);
    EXPECT_TRUE(succeeds(run));
    return run.out;
  }
};

TEST_F(SmoothTest, IsTheAngleOfAJsonScene) {
  KDRAY_NEED_DEVICE();
  const std::string flat = picture("flat.json"), smooth = picture("smooth.json");
  EXPECT_NE(flat, smooth);
  EXPECT_EQ(picture("flat.json", {"--smooth", "60"}), smooth);
  EXPECT_EQ(picture("flat.json", {"--smooth", "40"}), flat) << "the ridge turns by more";
  EXPECT_EQ(picture("smooth.json", {"--smooth", "40"}), smooth) << "normals of the file stay";
}

TEST_F(SmoothTest, IsPartOfWhatTheCacheLooksFor) {
  KDRAY_NEED_DEVICE();
  const std::vector<std::string> cache = {"--cache", folder / "cache"};
  const std::vector<std::string> smooth = {"--cache", folder / "cache", "--smooth", "60"};
  const std::string before = picture("flat.json", cache), wanted = picture("flat.json", smooth);
  EXPECT_NE(before, wanted);
  EXPECT_EQ(picture("flat.json", smooth), wanted);
  EXPECT_EQ(picture("flat.json", cache), before);
}

TEST_F(SmoothTest, AnglesThatAreNoneAreRefused) {
  for (const char* const angle : {"181", "-1", "nan", "", "round"})
    EXPECT_TRUE(
        fails_with(kdray({"info", folder / "tent.obj", std::string("--smooth=") + angle}), 2, "--smooth"))
        << angle;
}

}  // namespace
}  // namespace kdray::test
