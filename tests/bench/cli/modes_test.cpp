// What    kdray bench modes as a user runs it, on a scene of three primitives: exit codes, the report's keys.
//         No time is asserted.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "bench/cli/expect_keys.h"
#include "kdray/kdray.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

using Json = nlohmann::json;

TEST(BenchModes, WritesTablesFiguresAndPlots) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  const Outcome run =
      kdray({"bench", "modes", scene.string(), "--size", "48x32", "--depth", "3", "--repeat", "1", "--queues",
             "1,3", "--sample", "64", "--report", (folder / "report").string()});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.err.find("simulation, not measured"), std::string::npos) << run.err;
  const Json json = Json::parse(folder.get("report/modes.json"));
  expect_keys(json, {"command", "size", "depth", "repeat", "queues", "differing_pixels",
                     "thesis_pdprt_faster", "odprt_over_pdprt", "network", "runs"});
  EXPECT_EQ(json["differing_pixels"], 0);
  ASSERT_EQ(json["runs"].size(), 1u);
  const Json& bench_run = json["runs"][0];
  expect_keys(bench_run, {"scene", "device", "primitives", "cores", "scene_bytes", "rows", "model"});
  ASSERT_EQ(bench_run["rows"].size(), 2u + 2 * 6);
  EXPECT_EQ(bench_run["rows"][0]["scheme"], "sequential");
  EXPECT_EQ(bench_run["rows"][0]["speed_up"], 1);
  for (const Json& row : bench_run["rows"])
    expect_keys(row, {"scheme", "queues", "sub_devices", "shares_cores", "failure", "seconds", "rounds",
                      "speed_up", "idle_share", "busy_seconds", "rays_exchanged", "bytes_exchanged",
                      "geometry_bytes", "geometry_share", "work_bytes", "timeline", "differing_pixels"});
  const Json& model = bench_run["model"];
  expect_keys(model,
              {"simulation", "rays_per_sample", "tile", "odprt_overhead", "rays", "checks", "predictions"});
  EXPECT_NEAR(model["rays"][0]["sampled"].get<double>(), 48 * 32, 1e-6);
  bool to_the_end = false;
  for (const Json& p : model["predictions"]) {
    expect_keys(p, {"scheme", "queues", "seconds", "efficiency"});
    EXPECT_GT(p["efficiency"], 0);
    // ODPRT's own overhead is measured, and noise may have it below 1.
    const bool odprt = p["scheme"].get<std::string>().rfind("odprt", 0) == 0;
    const double overhead = odprt ? std::min(model["odprt_overhead"].get<double>(), 1.0) : 1.0;
    EXPECT_LT(p["efficiency"].get<double>(), 1.000001 / overhead) << p["scheme"];
    to_the_end |= p["queues"] == 10000;
  }
  EXPECT_TRUE(to_the_end);
  for (const char* const plot : {"modes.svg", "modes_time.svg", "modes_model.svg"})
    expect_plot(run, folder, std::string("report/") + plot, "</svg>");
}

TEST(BenchModes, MeasuresOnlyWhenTold) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  ASSERT_TRUE(succeeds(kdray({"bench", "modes", scene.string(), "--size", "16x16", "--repeat", "1",
                              "--queues", "1", "--no-model", "--report", folder.path().string()})));
  EXPECT_TRUE(Json::parse(folder.get("modes.json"))["runs"][0]["model"].is_null());
}

TEST(BenchModes, RefusesWhatItDoesNotKnow) {
  EXPECT_TRUE(fails_with(kdray({"bench", "modes", "--queues", "1,none"}), 2, "--queues"));
  EXPECT_TRUE(fails_with(kdray({"bench", "modes", "--queues", "0"}), 2, "--queues"));
  EXPECT_TRUE(fails_with(kdray({"bench", "modes", "--bandwidth", "0"}), 2, "--bandwidth"));
  EXPECT_TRUE(fails_with(kdray({"bench", "modes", "--latency", "-1"}), 2, "--latency"));
}

}  // namespace
}  // namespace kdray::test
