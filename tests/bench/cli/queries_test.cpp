// What    kdray bench queries as a user runs it, on a tiny mesh: exit codes, the report's keys. No time is
//         asserted.
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "bench/cli/expect_keys.h"
#include "kdray/kdray.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

using Json = nlohmann::json;

TEST(BenchQueriesCommand, WritesTableFiguresAndPlot) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  const Outcome run = kdray({"bench", "queries", scene.string(), "--rays", "100", "--batches", "1,100,5000",
                             "--repeat", "1", "--report", (folder / "report").string()});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.err.find("small: 2 triangles"), std::string::npos) << run.err;
  const Json json = Json::parse(folder.get("report/queries.json"));
  expect_keys(json, {"command", "embree", "rays", "repeat", "runs"});
  ASSERT_EQ(json["runs"].size(), 1u);
  const Json& bench_run = json["runs"][0];
  expect_keys(bench_run, {"scene", "triangles", "cores", "device", "vectors", "first_in_process",
                          "first_answers", "first_answer_ratios", "cells"});
  // Seven questions, three sets, and batches of 1 and 100: there are no more rays.
  ASSERT_EQ(bench_run["cells"].size(), 42u);
  for (const Json& cell : bench_run["cells"]) {
    expect_keys(cell, {"question", "set", "batch", "calls", "sides", "ratios", "on_device"});
    expect_keys(cell["ratios"], {"fast", "robust", "fast_cpu", "robust_cpu"});
    ASSERT_FALSE(cell["sides"].empty());
    EXPECT_EQ(cell["sides"][0]["side"], "kdray");
    for (const Json& side : cell["sides"]) {
      expect_keys(side, {"side", "form", "seconds", "cpu_seconds", "differing"});
      expect_keys(side["seconds"], {"median", "min", "max"});
      // The ball is left out, and Embree may count the edge in the middle of the square twice.
      EXPECT_LE(side["differing"], 15) << cell.dump();
    }
    const bool is_whole =
        cell["batch"] == 100 && (cell["question"] == "closest" || cell["question"] == "any");
    EXPECT_EQ(!cell["on_device"].is_null(), is_whole) << cell.dump();
  }
  expect_plot(run, folder, "report/queries.svg", "small: closest");
}

TEST(BenchQueriesCommand, LeavesEmbreeOutWhenTold) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  ASSERT_TRUE(succeeds(
      kdray({"bench", "queries", scene.string(), "--rays", "64", "--batches", "64", "--repeat", "1", "--sets",
             "random", "--queries", "count,points", "--no-embree", "--report", folder.path().string()})));
  const Json json = Json::parse(folder.get("queries.json"));
  EXPECT_TRUE(json["embree"].is_null());
  ASSERT_EQ(json["runs"][0]["cells"].size(), 2u);
  for (const Json& cell : json["runs"][0]["cells"]) EXPECT_EQ(cell["sides"].size(), 1u);
}

TEST(BenchQueriesCommand, RefusesWhatItDoesNotKnow) {
  EXPECT_TRUE(fails_with(kdray({"bench", "queries", "--queries", "closest,none"}), 2, "--queries"));
  EXPECT_TRUE(fails_with(kdray({"bench", "queries", "--sets", "wild"}), 2, "--sets"));
  EXPECT_TRUE(fails_with(kdray({"bench", "queries", "--batches", "1,0"}), 2, "--batches"));
  EXPECT_TRUE(fails_with(kdray({"bench", "queries", "nothing.nff"}), 1, "nothing.nff"));
}

TEST(BenchQueriesCommand, WantsTriangles) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("ball.nff",
                                "v\nfrom 0 -6 3\nat 0 0 1\nup 0 0 1\nangle 40\nhither 0.1\n"
                                "resolution 8 8\nl 0 0 9\nf 1 1 1 1 0 1 0 0\ns 0 0 1 1\n");
  EXPECT_TRUE(fails_with(kdray({"bench", "queries", scene.string(), "--no-embree"}), 1, "no triangles"));
}

}  // namespace
}  // namespace kdray::test
