// What    kdray bench modes --ranks as a user runs it, on a scene of three primitives: by threads, and as
//         mpirun's processes. No time is asserted.
#include <nlohmann/json.hpp>

#include "bench/cli/expect_keys.h"
#include "cli/program.h"
#include "cli/scenes.h"
#include "kdray/kdray.h"
#include "support/folder.h"
#include "support/mpirun.h"

namespace kdray::test {
namespace {

using Json = nlohmann::json;

void expect_report(const Folder& folder, int most_ranks, const std::string& over) {
  const Json json = Json::parse(folder.get("report/ranks.json"));
  expect_keys(json, {"command", "size", "depth", "samples", "repeat", "links", "runs"});
  ASSERT_EQ(json["runs"].size(), 1u);
  const Json& run = json["runs"][0];
  expect_keys(run, {"scene", "primitives", "cores", "over", "measured", "largest_error", "checks",
                    "predictions", "odprt"});
  EXPECT_EQ(run["over"], over);
  EXPECT_GT(run["measured"]["busy_seconds"], 0);
  EXPECT_GT(run["measured"]["take_seconds"], 0);
  ASSERT_EQ(run["checks"].size(), 1u + 2u);
  for (const Json& check : run["checks"]) {
    EXPECT_LE(check["ranks"], most_ranks);
    EXPECT_GT(check["predicted"]["median"], 0);
    EXPECT_GT(check["measured"]["median"], 0);
  }
  expect_keys(run["odprt"], {"size", "alone_seconds", "busy_seconds", "trace_share", "seconds_of_sent_ray",
                             "end_seconds", "largest_error", "checks", "predictions"});
  EXPECT_EQ(run["odprt"]["checks"].size(), 1u + 2u);
  EXPECT_EQ(run["odprt"]["predictions"].size(), 2u * 9);
  EXPECT_EQ(run["heavier"].size(), 2u * 5);
  EXPECT_EQ(run["predictions"].size(), 2u * 14);
  EXPECT_EQ(run["predictions"].back()["ranks"], 10000);
  EXPECT_NE(folder.get("report/ranks.svg").find("</svg>"), std::string::npos);
}

std::vector<std::string> command(const Folder& folder, const std::filesystem::path& scene) {
  return {"bench",    "modes", scene.string(), "--ranks", "--size",   "48x32",
          "--repeat", "1",     "--queues",     "1,2",     "--report", (folder / "report").string()};
}

TEST(BenchRanks, ByThreads) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  const Outcome run = kdray(command(folder, scene), {.limit_seconds = 280});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.err.find("a core to each rank, simulated"), std::string::npos) << run.err;
  expect_report(folder, 2, "threads");
}

TEST(BenchRanks, ByProcessesOfMpirun) {
  KDRAY_NEED_DEVICE();
  if (mpirun().empty()) GTEST_SKIP() << "no mpirun";
  const Folder folder;
  const auto scene = folder.put("small.nff", kSphereOnSquare);
  RunOptions options;
  options.program = mpirun();
  options.environment = mpirun_environment();
  options.limit_seconds = 280;
  const Outcome run = kdray(mpirun_arguments(2, KDRAY_PROGRAM, command(folder, scene)), options);
  ASSERT_TRUE(succeeds(run));
  expect_report(folder, 2, "MPI");
}

}  // namespace
}  // namespace kdray::test
