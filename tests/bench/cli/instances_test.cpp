// What    kdray bench instances as a user runs it, on a tiny mesh: exit codes, the report's keys. No time is
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

TEST(BenchInstances, WritesTableFiguresAndPlot) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const Outcome run = kdray({"bench", "instances", "tetra", "--rays", "400", "--repeat", "1", "--apart",
                             "1,0.5", "--across", "2", "--report", (folder / "report").string()});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.err.find("tetra: 4 instances of "), std::string::npos) << run.err;
  const Json json = Json::parse(folder.get("report/instances.json"));
  expect_keys(json, {"command", "embree", "across", "rays", "repeat", "not_identical", "runs"});
  EXPECT_EQ(json["not_identical"], 0);
  ASSERT_EQ(json["runs"].size(), 2u);
  const Json& bench_run = json["runs"][1];
  expect_keys(bench_run, {"mesh", "apart", "instances", "triangles", "instances_bytes", "copies_bytes",
                          "cores", "device", "vectors", "classes"});
  EXPECT_EQ(bench_run["apart"], 0.5);
  EXPECT_EQ(bench_run["instances"], 4);
  EXPECT_LT(bench_run["instances_bytes"], bench_run["copies_bytes"]);
  ASSERT_EQ(bench_run["classes"].size(), 4u);
  for (const Json& c : bench_run["classes"]) {
    expect_keys(c, {"name", "any_hit", "rays", "hits", "differing_share", "contestants", "times_copies"});
    EXPECT_LT(c["differing_share"], 0.05) << c["name"];
    ASSERT_GE(c["contestants"].size(), 4u) << "wide, packet, batch, auto";
    for (const Json& contestant : c["contestants"]) {
      expect_keys(contestant, {"family", "mode", "instances", "copies", "times_copies"});
      for (const char* const form : {"instances", "copies"}) {
        expect_keys(contestant[form], {"flag", "seconds", "mrays_per_s", "differing_share"});
        EXPECT_LE(contestant[form]["differing_share"], 0.05) << contestant.dump();
      }
    }
    expect_keys(c["times_copies"], {"kdray", "fast", "robust"});
    EXPECT_GT(c["times_copies"]["kdray"], 0);
  }
  expect_plot(run, folder, "report/instances.svg", "kdray, instances");
}

TEST(BenchInstances, RefusesWhatItDoesNotKnow) {
  EXPECT_TRUE(fails_with(kdray({"bench", "instances", "--traversals", "binary"}), 2, "--traversals"));
  EXPECT_TRUE(fails_with(kdray({"bench", "instances", "--apart", "0"}), 2, "--apart"));
  EXPECT_TRUE(
      fails_with(kdray({"bench", "instances", "shells", "--rays", "9", "--no-embree"}), 1, "no triangles"));
}

}  // namespace
}  // namespace kdray::test
