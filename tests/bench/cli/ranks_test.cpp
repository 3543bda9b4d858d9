// What    kdray bench modes --ranks as a user runs it, on a scene of three primitives: by threads, and as
//         mpirun's processes. No time is asserted.
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "bench/cli/expect_keys.h"
#include "kdray/kdray.h"
#include "support/folder.h"
#include "support/mpirun.h"

namespace kdray::test {
namespace {

using Json = nlohmann::json;

void expect_report(const Outcome& bench, const Folder& folder, int most_ranks, const std::string& over) {
  const Json json = Json::parse(folder.get("report/ranks.json"));
  expect_keys(json, {"command", "size", "depth", "samples", "repeat", "runs"});
  ASSERT_EQ(json["runs"].size(), 1u);
  const Json& run = json["runs"][0];
  expect_keys(run, {"scene", "device", "primitives", "cores", "over", "network", "at_once", "modes"});
  EXPECT_EQ(run["over"], over);
  EXPECT_GT(run["network"]["take_seconds"], 0);
  EXPECT_EQ(run["at_once"].size(), 2u);
  ASSERT_EQ(run["modes"].size(), 2u);
  for (const Json& mode : run["modes"]) {
    expect_keys(mode, {"mode", "alone_seconds", "rows"});
    ASSERT_EQ(mode["rows"].size(), 1u + 2u) << "several ranks with a delay and without";
    for (const Json& row : mode["rows"]) {
      expect_keys(row, {"ranks", "delay_seconds", "seconds", "rounds", "speed_up", "share_of_cores",
                        "busy_seconds", "messages", "bytes", "rays_sent", "differing_pictures"});
      EXPECT_LE(row["ranks"], most_ranks);
      EXPECT_EQ(row["rounds"].size(), 1u);
      EXPECT_GT(row["busy_seconds"], 0);
      EXPECT_EQ(row["messages"] > 0, row["ranks"] > 1);
      EXPECT_EQ(row["differing_pictures"], 0);
    }
  }
  EXPECT_GT(run["modes"][1]["rows"][2]["rays_sent"], 0) << "ODPRT by two ranks";
  expect_plot(bench, folder, "report/ranks.svg", "ODPRT");
}

std::vector<std::string> command(const Folder& folder, const std::filesystem::path& scene) {
  return {"bench",    "modes", scene.string(), "--ranks", "--size",   "48x32",
          "--repeat", "1",     "--queues",     "1,2",     "--report", (folder / "report").string()};
}

TEST(BenchRanks, ByThreads) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  const Outcome run = kdray(command(folder, scene));
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.err.find("at once, each by itself: 1 of speed"), std::string::npos) << run.err;
  expect_report(run, folder, 2, "threads");
}

TEST(BenchRanks, ByProcessesOfMpirun) {
  KDRAY_NEED_DEVICE();
  if (mpirun().empty()) GTEST_SKIP() << "no mpirun";
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  RunOptions options;
  options.program = mpirun();
  options.environment = mpirun_environment();
  const Outcome run = kdray(mpirun_arguments(2, KDRAY_PROGRAM, command(folder, scene)), options);
  ASSERT_TRUE(succeeds(run));
  expect_report(run, folder, 2, "MPI");
}

}  // namespace
}  // namespace kdray::test
