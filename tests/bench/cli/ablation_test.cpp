// What    kdray bench ablation as a user runs it, on a scene of three primitives: exit codes, the report's
//         keys, and that no exact rule changes a bit. No time is asserted.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "kdray/kdray.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

using Json = nlohmann::json;

const Json& row(const Json& run, const std::string& without) {
  for (const Json& r : run["rows"])
    if (r["without"] == without) return r;
  throw std::runtime_error("no row " + without);
}

void expect_numbers(const Json& spread) {
  for (const char* const key : {"median", "min", "max"}) {
    ASSERT_TRUE(spread[key].is_number()) << spread.dump();  // NaN would be null
    EXPECT_GT(spread[key], 0);
  }
}

// The missing scene is told before the first one is measured, which would be for nothing.
TEST(BenchAblation, AMissingSceneIsToldAtOnce) {
  const Outcome run = kdray({"bench", "ablation", "boxes", "no_such_scene"});
  EXPECT_TRUE(fails_with(run, 1, "no_such_scene: neither a file nor a built-in scene"));
}

TEST(BenchAblation, WritesTableFiguresAndPlot) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  const Outcome run = kdray({"bench", "ablation", scene.string(), "--size", "32x24", "--depth", "2",
                             "--repeat", "2", "--report", (folder / "report").string(), "--only", "no cones",
                             "shadow rays to lights behind", "everything exact"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.err.find("everything exact"), std::string::npos) << run.err;
  const Json json = Json::parse(folder.get("report/ablation.json"));
  EXPECT_EQ(json["command"], "bench ablation");
  EXPECT_EQ(json["inexact"], 0);
  ASSERT_EQ(json["runs"].size(), 1u);
  const Json& found = json["runs"][0];
  EXPECT_EQ(found["rows"][0]["kind"], "none");
  EXPECT_EQ(found["rows"].size(), 4u);
  for (const Json& r : found["rows"]) {
    expect_numbers(r["seconds"]);
    expect_numbers(r["ratio"]);
    EXPECT_TRUE(r["compile_seconds"].is_null() || r["compile_seconds"] >= 0);
    EXPECT_EQ(r["rays"]["primary"], 32 * 24);
    if (r["exact"]) {
      EXPECT_EQ(r["differing_values"], 0) << r["without"];
    }
  }
  // What a rule leaves out is there without it.
  EXPECT_GT(row(found, "shadow rays to lights behind")["rays"]["shadow"], found["rows"][0]["rays"]["shadow"]);
  EXPECT_EQ(row(found, "no cones")["kind"], "specialisation");
  expect_plot(run, folder, "report/ablation.svg", ">no cones<");
}

TEST(BenchAblation, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(kdray({"bench", "ablation", "--depth", "0"}).code, 2);
  EXPECT_EQ(kdray({"bench", "ablation", "--cut", "1"}).code, 2);
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const std::string scene = folder.put("small.nff", kSphereOnSquare);
  const Outcome run = kdray({"bench", "ablation", scene, "--size", "8x8", "--only", "no triangles"});
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("small.nff this can be taken away: no cones, "), std::string::npos) << run.err;
}

}  // namespace
}  // namespace kdray::test
