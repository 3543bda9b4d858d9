// What    The scene cache through the real program: what a second run finds, and that no trouble with the
//         cache costs a picture.
#include <atomic>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// 65 thousand triangles take well over the 2 MiB from which on a scene is kept.
fs::path large_scene(const Folder& folder) {
  EXPECT_TRUE(succeeds(kdray({"generate", "tetra", "--size", "8", "-o", folder / "tetra.nff"})));
  return folder / "tetra.nff";
}

struct Rendered {
  Outcome outcome;
  Json stats;
  std::string picture;
};

Rendered render(const Folder& folder, const fs::path& scene, const std::vector<std::string>& more,
                const std::map<std::string, std::string>& environment = {}) {
  std::vector<std::string> arguments = {"render",         scene,     "--size",         "64x64", "-o",
                                        folder / "a.png", "--stats", folder / "s.json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  Rendered run{kdray(arguments, {.environment = environment}), {}, {}};
  EXPECT_TRUE(succeeds(run.outcome));
  run.stats = Json::parse(folder.get("s.json"));
  run.picture = folder.get("a.png");
  return run;
}

std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!exists(folder)) return files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (!entry.is_directory()) files.push_back(entry.path());  // not the programs
  return files;
}

TEST(CacheOption, SecondRunFindsTheScene) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = large_scene(folder);
  const std::string cache = folder / "cache";
  const Rendered off = render(folder, scene, {"--no-cache"});
  const Rendered miss = render(folder, scene, {"--cache", cache});
  const Rendered hit = render(folder, scene, {"--cache", cache, "--verbose"});
  EXPECT_EQ(off.stats["cache"], "off");
  EXPECT_EQ(miss.stats["cache"], "miss");
  EXPECT_EQ(hit.stats["cache"], "hit");
  EXPECT_EQ(off.stats["seconds"]["cache"], 0);
  EXPECT_GT(hit.stats["seconds"]["cache"], 0);
  for (const char* name : {"load", "build", "flatten"}) {
    EXPECT_GT(miss.stats["seconds"][name], 0) << name;
    EXPECT_EQ(hit.stats["seconds"][name], 0) << name;
  }
  for (const char* name : {"scene", "tree", "features", "rays"})
    EXPECT_EQ(hit.stats[name], off.stats[name]) << name;
  EXPECT_EQ(miss.picture, off.picture);
  EXPECT_EQ(hit.picture, off.picture);
  EXPECT_NE(hit.outcome.err.find("cache hit"), std::string::npos) << hit.outcome.err;
  EXPECT_EQ(entries(cache).size(), 1u);
}

TEST(CacheOption, DamagedEntryIsRebuilt) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = large_scene(folder);
  const std::string cache = folder / "cache";
  const Rendered whole = render(folder, scene, {"--cache", cache});
  ASSERT_EQ(entries(cache).size(), 1u);
  const fs::path entry = entries(cache).front();
  const auto damage = [&](std::streamoff at) {
    std::fstream file(entry, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(at);
    const char byte = static_cast<char>(file.get() ^ 4);
    file.seekp(at);
    file.put(byte);
  };
  const auto size = static_cast<std::streamoff>(file_size(entry));
  for (const std::streamoff at : {std::streamoff{0}, std::streamoff{9}, std::streamoff{4096}, size / 2}) {
    damage(at);
    const Rendered run = render(folder, scene, {"--cache", cache});
    EXPECT_EQ(run.stats["cache"], "miss") << "byte " << at;
    EXPECT_EQ(run.picture, whole.picture) << "byte " << at;
    EXPECT_EQ(render(folder, scene, {"--cache", cache}).stats["cache"], "hit") << "byte " << at;
  }
}

TEST(CacheOption, QuicklyMadeScenesAreNotKept) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const auto stats = render(folder, scene, {"--cache", folder / "cache"}).stats;
  EXPECT_EQ(stats["cache"], "miss");
  double seconds = 0;
  for (const char* const step : {"load", "build", "flatten"}) seconds += stats["seconds"][step].get<double>();
  if (seconds >= 0.05) GTEST_SKIP() << "a busy machine: it took " << seconds << " s";
  for (const auto& entry : fs::directory_iterator(folder / "cache"))
    EXPECT_EQ(entry.path().filename(), "programs") << "built programs are kept all the same";
}

TEST(CacheOption, TheUsersOwnFolderIsTheDefault) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = large_scene(folder);
  const std::map<std::string, std::string> environment = {{"KDRAY_CACHE_DIR", folder / "own"}};
  EXPECT_EQ(render(folder, scene, {}, environment).stats["cache"], "miss");
  EXPECT_EQ(render(folder, scene, {}, environment).stats["cache"], "hit");
  EXPECT_EQ(render(folder, scene, {"--no-cache"}, environment).stats["cache"], "off");
  EXPECT_EQ(render(folder, scene, {}, {{"KDRAY_CACHE_DIR", ""}}).stats["cache"], "off");
  EXPECT_EQ(entries(folder / "own").size(), 1u);
}

TEST(CacheOption, AFolderThatCannotBeWrittenIsAWarningAtMost) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = large_scene(folder);
  const std::string file = folder.put("file", "no folder");
  const Rendered asked = render(folder, scene, {"--cache", file});
  EXPECT_EQ(asked.stats["cache"], "miss");
  EXPECT_NE(asked.outcome.err.find("cache can't be made"), std::string::npos) << asked.outcome.err;
  const Rendered quiet = render(folder, scene, {"--cache", file, "--quiet"});
  EXPECT_EQ(quiet.outcome.err, "");
  const Rendered unasked = render(folder, scene, {}, {{"KDRAY_CACHE_DIR", file}});
  EXPECT_EQ(unasked.outcome.err.find("cache can't"), std::string::npos) << unasked.outcome.err;
  EXPECT_EQ(asked.picture, unasked.picture);
}

TEST(CacheOption, TooSmallACacheKeepsNothing) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  render(folder, large_scene(folder), {"--cache", folder / "cache", "--cache-size", "1M"});
  EXPECT_TRUE(entries(folder / "cache").empty());
}

TEST(CacheOption, SeveralProcessesAtOnce) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = large_scene(folder);
  std::atomic<int> n_good = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 3; ++t)
      threads.emplace_back([&, t] {
        const std::string picture = folder / ("p" + std::to_string(t) + ".png");
        for (int i = 0; i < 3; ++i)
          n_good +=
              kdray({"render", scene, "--size", "64x64", "-o", picture, "--cache", folder / "cache"}).code ==
              0;
      });
  }
  EXPECT_EQ(n_good, 9);
  EXPECT_EQ(entries(folder / "cache").size(), 1u) << "temporary files are left";
  EXPECT_EQ(folder.get("p0.png"), folder.get("p1.png"));
  EXPECT_EQ(folder.get("p0.png"), folder.get("p2.png"));
  EXPECT_EQ(render(folder, scene, {"--cache", folder / "cache"}).stats["cache"], "hit");
}

TEST(CacheOption, WrongValuesAreUsageErrors) {
  EXPECT_TRUE(fails_with(kdray({"render", "a.nff", "--cache-size", "much"}), 2, "--cache-size"));
  EXPECT_TRUE(
      fails_with(kdray({"trace", "a.nff", "--rays", "r.npy", "-o", "h.npy", "--cache", ""}), 2, "--cache"));
}

}  // namespace
}  // namespace kdray::test
