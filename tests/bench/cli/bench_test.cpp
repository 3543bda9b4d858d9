// What    kdray bench as a user runs it, on a scene of three primitives: exit codes, the report's keys. No
//         time is asserted.
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "bench/cli/expect_keys.h"
#include "kdray/kdray.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

using Json = nlohmann::json;

TEST(BenchRays, WritesTableFiguresAndPlot) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  const Outcome run = kdray({"bench", "rays", scene.string(), "--rays", "1000", "--repeat", "1", "--cores",
                             "all", "--traversals", "binary,wide", "--report", (folder / "report").string()});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.err.find("small.nff: 2 triangles, 1 spheres,"), std::string::npos) << run.err;
  const Json json = Json::parse(folder.get("report/rays.json"));
  expect_keys(json, {"command", "embree", "rays", "repeat", "not_identical", "runs"});
  EXPECT_EQ(json["not_identical"], 0);
  ASSERT_EQ(json["runs"].size(), 1u);
  const Json& bench_run = json["runs"][0];
  expect_keys(bench_run, {"scene", "primitives", "instances", "cores", "device", "vectors", "classes"});
  ASSERT_EQ(bench_run["classes"].size(), 7u);
  for (const Json& c : bench_run["classes"]) {
    expect_keys(c, {"name", "any_hit", "rays", "hits", "contestants", "ratios"});
    EXPECT_LE(c["rays"], 31 * 31);
    ASSERT_GE(c["contestants"].size(), 2u);
    expect_keys(c["contestants"][0],
                {"family", "mode", "flag", "seconds", "mrays_per_s", "differing_share", "not_identical"});
    expect_keys(c["contestants"][0]["seconds"], {"median", "min", "max"});
    expect_keys(c["ratios"],
                {"best_to_fast", "best_to_robust", "auto_to_fast", "auto_to_robust", "auto_to_best_fixed"});
  }
  expect_plot(run, folder, "report/rays.svg", "kdray wide");
}

TEST(BenchRays, LeavesEmbreeOutWhenTold) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  const Outcome run =
      kdray({"bench", "rays", scene.string(), "--rays", "64", "--repeat", "1", "--cores", "all", "--classes",
             "primary", "--no-embree", "--report", folder.path().string()});
  ASSERT_TRUE(succeeds(run));
  const Json json = Json::parse(folder.get("rays.json"));
  EXPECT_TRUE(json["embree"].is_null());
  for (const Json& contestant : json["runs"][0]["classes"][0]["contestants"])
    EXPECT_EQ(contestant["family"], "kdray");
  EXPECT_EQ(folder.get("rays.svg").find("Embree"), std::string::npos);
}

TEST(BenchRays, RefusesAnEmbreeThatIsNone) {
  KDRAY_NEED_DEVICE();
  const std::vector<std::string> arguments = {"bench",    "rays", "tetra",     "--rays", "64",
                                              "--repeat", "1",    "--classes", "primary"};
  const auto with = [&](const std::string& file) {
    return kdray(arguments, {.environment = {{"KDRAY_EMBREE", file}}});
  };
  EXPECT_TRUE(fails_with(with("/nowhere/libembree4.so"), 1, "/nowhere/libembree4.so"));
  EXPECT_TRUE(fails_with(with("libm.so.6"), 1, "no Embree: it has no rtcNewDevice"));
}

// As on a machine whose python3 has no matplotlib, or that has no python3.
TEST(BenchRays, FiguresAreThereWhereNoPlotCanBeDrawn) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  folder.put("matplotlib.py", "raise ImportError");
  const Outcome run = kdray({"bench", "rays", scene.string(), "--rays", "64", "--repeat", "1", "--cores",
                             "all", "--classes", "primary", "--report", folder.path().string()},
                            {.environment = {{"PYTHONPATH", folder.path().string()}}});
  ASSERT_TRUE(succeeds(run));
  EXPECT_TRUE(has_no_plots(run)) << run.err;
  EXPECT_EQ(Json::parse(folder.get("rays.json"))["runs"].size(), 1u);
  EXPECT_EQ(folder.get("rays.svg"), "");
}

TEST(BenchFrames, WritesTableFiguresAndPlot) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  const Outcome run = kdray({"bench", "frames", scene.string(), "--size", "32x24", "--depth", "2", "--repeat",
                             "1", "--report", (folder / "report").string()});
  ASSERT_TRUE(succeeds(run));
  const Json json = Json::parse(folder.get("report/frames.json"));
  expect_keys(json, {"command", "embree", "size", "depth", "repeat", "frames"});
  ASSERT_EQ(json["frames"].size(), 1u);
  const Json& frame = json["frames"][0];
  expect_keys(frame, {"scene", "primitives", "cores", "device", "seconds", "mrays_per_s", "stages", "rays",
                      "povray_seconds", "povray_ratio", "embree", "embree_ratio"});
  EXPECT_EQ(frame["rays"]["primary"], 32 * 24);
  expect_plot(run, folder, "report/frames.svg", ">small<");
}

TEST(BenchRays, RunsOnOneCoreAndOnAll) {
  KDRAY_NEED_DEVICE();
  for (const DeviceInfo& device : devices())
    if (device.usable && device.kind != "cpu")
      GTEST_SKIP() << "a GPU would be taken, which has no cores to choose";
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  ASSERT_TRUE(succeeds(kdray({"bench", "rays", scene.string(), "--rays", "64", "--repeat", "1", "--classes",
                              "primary", "--traversals", "binary", "--report", folder.path().string()})));
  const Json runs = Json::parse(folder.get("rays.json"))["runs"];
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0]["cores"], 1);
  EXPECT_GE(runs[1]["cores"], 1);
}

TEST(Bench, RefusesWhatItDoesNotKnow) {
  EXPECT_TRUE(fails_with(kdray({"bench"}), 2, "rays, queries, frames"));
  EXPECT_TRUE(fails_with(kdray({"bench", "modesty"}), 2, "modesty"));
  EXPECT_TRUE(fails_with(kdray({"bench", "rays", "--classes", "primary,none"}), 2, "--classes"));
  EXPECT_TRUE(fails_with(kdray({"bench", "rays", "--traversals", "all"}), 2, "--traversals"));
  EXPECT_TRUE(fails_with(kdray({"bench", "rays", "--cores", "1,many"}), 2, "--cores"));
  EXPECT_TRUE(fails_with(kdray({"bench", "rays", "--cores", "0"}), 2, "--cores"));
  EXPECT_TRUE(fails_with(kdray({"bench", "frames", "--size", "0x4"}), 2, "--size"));
}

// Without scenes a bench would measure nothing, and succeed.
TEST(Bench, EachNamesTheScenesThatItTakesWithoutOthers) {
  for (const char* const bench :
       {"rays", "queries", "frames", "build", "depth", "modes", "accuracy", "ablation", "instances"}) {
    const Outcome run = kdray({"bench", bench, "--help"});
    ASSERT_TRUE(succeeds(run)) << bench;
    const std::size_t scenes = run.out.find("names of built-in scenes (default: ");
    ASSERT_NE(scenes, std::string::npos) << run.out;
    EXPECT_NE(run.out[run.out.find("default: ", scenes) + 9], ')') << bench;
  }
}

TEST(Bench, AFolderThatCannotBeMadeIsToldFirst) {
  const Folder folder;
  const auto file = folder.put("file", "");
  EXPECT_TRUE(
      fails_with(kdray({"bench", "rays", "tetra", "--report", (file / "report").string()}), 1, "file"));
}

}  // namespace
}  // namespace kdray::test
