// What    kdray bench build and bench depth as a user runs them, on small scenes: exit codes, the reports'
//         keys, every tree giving the same hits. No time is asserted.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "bench/cli/expect_keys.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

using Json = nlohmann::json;

void expect_times(const Json& seconds) {
  expect_keys(seconds, {"tree", "flatten", "total", "cpu"});
  EXPECT_GT(seconds["tree"]["median"], 0.0);
  EXPECT_GE(seconds["total"]["max"], seconds["total"]["min"]);
}

void expect_tree(const Json& tree) {
  EXPECT_GE(tree["duplication"], 1.0);
  for (const char* const key : {"sah_cost", "tight_cost", "binary_bytes", "wide_bytes"})
    EXPECT_GT(tree[key], 0) << key;
}

// About 800 spheres on a square.
std::string balls(const Folder& folder) {
  const auto file = folder / "balls.nff";
  EXPECT_TRUE(succeeds(kdray({"generate", "balls", "--size", "3", "-o", file.string()})));
  return file.string();
}

TEST(BenchBuild, WritesTableFiguresAndPlot) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const Outcome run = kdray({"bench", "build", balls(folder), "--variants", "--rays", "400", "--repeat", "1",
                             "--no-embree", "--report", (folder / "report").string()});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.err.find("balls: 2 triangles, 820 spheres,"), std::string::npos) << run.err;
  const Json json = Json::parse(folder.get("report/build.json"));
  expect_keys(json, {"command", "embree", "rays", "repeat", "not_identical", "runs"});
  EXPECT_EQ(json["not_identical"], 0);
  ASSERT_EQ(json["runs"].size(), 1u);
  expect_keys(json["runs"][0], {"scene", "primitives", "cores", "device", "builders"});
  std::vector<std::string> names;
  for (const Json& b : json["runs"][0]["builders"]) {
    names.push_back(b["builder"]);
    expect_times(b["seconds"]);
    expect_tree(b["tree"]);
    EXPECT_GT(b["trace_seconds"], 0.0);
    ASSERT_EQ(b["traces"].size(), 3u);
    for (const Json& t : b["traces"]) {
      expect_keys(t, {"class", "rays", "seconds", "mrays_per_s", "not_identical"});
      EXPECT_EQ(t["not_identical"], 0) << b["builder"] << " " << t["class"];
    }
  }
  EXPECT_EQ(names, (std::vector<std::string>{"fast", "balanced", "best", "perfect", "boxed", "spatial median",
                                             "object median"}));
  expect_plot(run, folder, "report/build.svg", ">object median<");
}

TEST(BenchBuild, HasEmbreeWhereItIs) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  ASSERT_TRUE(succeeds(kdray({"bench", "build", balls(folder), "--rays", "400", "--repeat", "1", "--report",
                              folder.path().string()})));
  const Json json = Json::parse(folder.get("build.json"));
  const Json& builders = json["runs"][0]["builders"];
  if (json["embree"].is_null()) {
    EXPECT_EQ(builders.size(), 3u);
    GTEST_SKIP() << "no Embree is found";
  }
  ASSERT_GT(builders.size(), 3u);
  double fastest = 1e9;
  for (std::size_t i = 3; i < builders.size(); ++i) {
    EXPECT_EQ(builders[i]["builder"].get<std::string>().substr(0, 7), "Embree ");
    EXPECT_TRUE(builders[i]["tree"].is_null());
    expect_times(builders[i]["seconds"]);
    EXPECT_EQ(builders[i]["traces"].size(), 3u);
    fastest = std::min(fastest, builders[i]["times_embree"].get<double>());
  }
  EXPECT_EQ(fastest, 1.0);
  for (const Json& b : builders) {
    EXPECT_GT(b["times_embree"], 0.0);
    EXPECT_GT(b["cpu_times_embree"], 0.0);
  }
}

TEST(BenchBuild, GrowthTellsTimeAndMemoryForEachSize) {
  const Folder folder;
  const Outcome run = kdray({"bench", "build", "--growth", "--triangles", "10000", "--repeat", "1",
                             "--no-embree", "--report", folder.path().string()});
  ASSERT_TRUE(succeeds(run));
  const Json json = Json::parse(folder.get("growth.json"));
  ASSERT_EQ(json["sizes"].size(), 1u);
  EXPECT_GE(json["sizes"][0]["triangles"], 10000);
  ASSERT_EQ(json["sizes"][0]["builders"].size(), 3u);
  for (const Json& b : json["sizes"][0]["builders"]) {
    expect_times(b["seconds"]);
    EXPECT_GT(b["nanoseconds_per_triangle"], 0.0);
    EXPECT_EQ(b["growth_over_n_log_n"], 1.0);  // the smallest
    EXPECT_GE(b["duplication"], 1.0);
    expect_keys(b, {"peak_bytes"});
  }
  expect_plot(run, folder, "growth.svg", ">balanced<");
}

TEST(BenchBuild, HostileMeshesAreHeldAgainstAPlainOne) {
  const Folder folder;
  const Outcome run = kdray({"bench", "build", "fan", "same", "--hostile", "--triangles", "1000", "--repeat",
                             "1", "--report", folder.path().string()});
  ASSERT_TRUE(succeeds(run));
  const Json json = Json::parse(folder.get("hostile.json"));
  ASSERT_EQ(json["meshes"].size(), 2u);
  EXPECT_EQ(json["meshes"][0]["mesh"], "same");  // in the list's own order
  EXPECT_EQ(json["meshes"][0]["duplication"], 1.0);
  EXPECT_EQ(json["meshes"][1]["mesh"], "fan");
  for (const Json& m : json["meshes"]) {
    EXPECT_EQ(m["triangles"], 1000);
    expect_times(m["seconds"]);
    expect_times(m["plain_seconds"]);
    EXPECT_GT(m["times_plain"], 0.0);
    expect_keys(m, {"what", "cpu_times_plain", "plain_duplication", "wide_bytes", "plain_wide_bytes",
                    "tight_cost", "plain_tight_cost", "largest_leaf", "max_depth"});
  }
  expect_plot(run, folder, "hostile.svg", ">fan<");
}

TEST(BenchDepth, WritesTableFiguresAndPlot) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const Outcome run = kdray({"bench", "depth", balls(folder), "--rays", "400", "--repeat", "1", "--build",
                             "fast", "--report", folder.path().string()});
  ASSERT_TRUE(succeeds(run));
  const Json json = Json::parse(folder.get("depth.json"));
  expect_keys(json, {"command", "build", "rays", "repeat", "not_identical", "runs"});
  EXPECT_EQ(json["build"], "fast");
  EXPECT_EQ(json["not_identical"], 0);
  const Json& depths = json["runs"][0]["depths"];
  ASSERT_GE(depths.size(), 10u);
  for (const Json& d : depths) {
    expect_times(d["seconds"]);
    expect_tree(d["tree"]);
    EXPECT_LE(d["tree"]["max_depth"], d["max_depth"]);
    EXPECT_EQ(d["trace_seconds"].is_null(), d["tree"]["tight_cost"] > 1000);
  }
  EXPECT_EQ(depths[0]["tree"]["max_depth"], 0);
  EXPECT_GT(depths[0]["tree"]["sah_cost"], depths.back()["tree"]["sah_cost"]);
  expect_plot(run, folder, "depth.svg", ">balls<");
}

TEST(BenchBuild, RefusesWhatItDoesNotKnow) {
  EXPECT_TRUE(fails_with(kdray({"bench", "build", "--growth", "--hostile"}), 2, "--growth"));
  EXPECT_TRUE(fails_with(kdray({"bench", "build", "boxes", "--growth"}), 2, "--growth"));
  EXPECT_TRUE(fails_with(kdray({"bench", "build", "friendly", "--hostile"}), 2, "needles"));
  EXPECT_TRUE(fails_with(kdray({"bench", "build", "--repeat", "0"}), 2, "--repeat"));
  EXPECT_TRUE(fails_with(kdray({"bench", "build", "nosuch", "--repeat", "1"}), 1, "nosuch"));
  EXPECT_TRUE(fails_with(kdray({"bench", "depth", "--build", "slow"}), 2, "fast, balanced, best"));
}

TEST(BenchBuild, AnEmptySceneIsToldAsSuch) {
  const Folder folder;
  const auto scene = folder.put("none.nff", "b 0 0 0\n");
  for (const char* const bench : {"build", "depth"})
    EXPECT_EQ(kdray({"bench", bench, scene.string()}).code, 1);
}

}  // namespace
}  // namespace kdray::test
