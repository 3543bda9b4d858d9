// What    Starts through the real program: programs that are found again, a device that fails the self-test.
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

fs::path small_scene(const Folder& folder) {
  EXPECT_TRUE(succeeds(kdray({"generate", "balls", "--size", "1", "-o", folder / "balls.nff"})));
  return folder / "balls.nff";
}

Outcome render_into(const Folder& folder, std::vector<std::string> more,
                    const std::map<std::string, std::string>& environment = {}) {
  std::vector<std::string> arguments = {"render", folder / "balls.nff", "--size", "32x32",
                                        "-o",     folder / "a.png"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return kdray(arguments, {.environment = environment});
}

std::size_t n_programs(const fs::path& folder) {
  std::size_t n = 0;
  if (exists(folder))
    for (const auto& entry : fs::directory_iterator(folder)) n += entry.path().extension() == ".program";
  return n;
}

TEST(Start, ProgramsAreKeptAndFoundAndTheFolderIsNotThePicturesConcern) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  small_scene(folder);
  ASSERT_TRUE(succeeds(render_into(folder, {"--cache", folder / "cache"})));
  const std::size_t n = n_programs(folder / "cache" / "programs");
  EXPECT_GE(n, 2u) << "the render's program, the vectors' test, the self-test's outcome";
  const std::string picture = folder.get("a.png");
  ASSERT_TRUE(succeeds(render_into(folder, {"--cache", folder / "cache"})));
  EXPECT_EQ(n_programs(folder / "cache" / "programs"), n) << "nothing was built";
  EXPECT_EQ(folder.get("a.png"), picture);
  for (const auto& entry : fs::directory_iterator(folder / "cache" / "programs"))
    std::ofstream(entry.path(), std::ios::trunc) << "damaged";
  ASSERT_TRUE(succeeds(render_into(folder, {"--cache", folder / "cache"})));
  EXPECT_EQ(folder.get("a.png"), picture);
}

TEST(Start, NoCacheKeepsNoProgramsAndTheEnvironmentNamesTheFolder) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  small_scene(folder);
  ASSERT_TRUE(succeeds(render_into(folder, {"--no-cache"}, {{"KDRAY_CACHE_DIR", folder / "own"}})));
  EXPECT_FALSE(exists(folder / "own"));
  ASSERT_TRUE(succeeds(render_into(folder, {}, {{"KDRAY_CACHE_DIR", folder / "own"}})));
  EXPECT_GE(n_programs(folder / "own" / "programs"), 2u);
}

// Stages one after the other, without the device time that is a part of `render`.
double sum_of_stages(const Json& seconds) {
  double sum = 0;
  for (const char* const stage : {"cache", "load", "start", "self_test", "build", "flatten", "upload",
                                  "compile", "prepare", "render", "keep_programs", "write"})
    sum += seconds.at(stage).get<double>();
  return sum;
}

TEST(Start, StagesOfAColdStartAreTimedAndLieWithinTheTotal) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  small_scene(folder);
  const std::map<std::string, std::string> nothing_kept = {{"XDG_CACHE_HOME", folder / "caches"},
                                                           {"POCL_CACHE_DIR", folder / "pocl"},
                                                           {"KDRAY_CACHE_DIR", folder / "kdray"}};
  fs::create_directories(folder / "pocl");
  for (const bool cold : {true, false}) {
    ASSERT_TRUE(succeeds(render_into(folder, {"--stats", folder / "s.json"}, nothing_kept)));
    const Json seconds = Json::parse(folder.get("s.json")).at("seconds");
    SCOPED_TRACE((cold ? "cold: " : "warm: ") + seconds.dump());
    const double total = seconds.at("total");
    EXPECT_LE(sum_of_stages(seconds), total);
    if (!cold) continue;
    for (const char* const stage : {"start", "self_test", "compile", "keep_programs"})
      EXPECT_GT(seconds.at(stage), 0.0) << stage;
  }
}

TEST(Start, ADeviceThatFailsTheSelfTestIsExitCode3WhenItWasNamed) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  small_scene(folder);
  EXPECT_TRUE(fails_with(render_into(folder, {"--device", "0", "--inject-fault", "self-test@0"}), 3,
                         "fails the self-test"));
  EXPECT_FALSE(exists(folder / "a.png"));
}

// PoCL gives as many devices as it is asked for.
TEST(Start, AutoGoesOnToTheNextDevice) {
  KDRAY_NEED_DEVICE();
  if (kdray({"devices"}).out.find("Portable Computing Language") == std::string::npos)
    GTEST_SKIP() << "no PoCL";
  const Folder folder;
  small_scene(folder);
  const std::map<std::string, std::string> two = {{"POCL_DEVICES", "pthread pthread"}};
  const Outcome devices = kdray({"devices", "--json"}, {.environment = two});
  if (Json::parse(devices.out).size() != 2) GTEST_SKIP() << "more than PoCL's two devices";
  const Outcome one = render_into(folder, {"--inject-fault", "self-test@0"}, two);
  ASSERT_TRUE(succeeds(one));
  EXPECT_NE(one.err.find("fails the self-test"), std::string::npos) << one.err;
  EXPECT_TRUE(fails_with(render_into(folder, {"-q", "--inject-fault", "self-test@0,self-test@1"}, two), 3,
                         "fails the self-test"));
}

}  // namespace
}  // namespace kdray::test
