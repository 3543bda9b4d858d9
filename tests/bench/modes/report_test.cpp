// What    What is made of measured rows: ratios, means, checks of the model, counts of differing pixels; and
//         that rows that failed are told and left out.
#include <gtest/gtest.h>

#include "bench/modes/bench.h"

namespace kdray::bench {
namespace {

ModesRow row(const std::string& scheme, int queues, double seconds) {
  ModesRow made{scheme, queues, std::min(queues, 2), ""};
  made.rounds = {seconds};
  made.seconds = {seconds, seconds, seconds};
  return made;
}

// Two cores; PDPRT is perfect on two queues, ODPRT takes `ratio` times as long.
ModesRun run(double ratio) {
  ModesRun made;
  made.scene = "scene.nff";
  made.machine.cores = 2;
  made.rows = {row("sequential", 1, 8), row("pdprt bag", 2, 4), row("odprt pilot", 2, 4 * ratio),
               row("pdprt bag", 4, 4)};
  made.rows.push_back({"odprt pilot", 4, 2, "no more memory"});
  return made;
}

TEST(ModesRun, SpeedUpIsOverOneCore) {
  const ModesRun made = run(2);
  EXPECT_DOUBLE_EQ(made.speed_up(made.rows[1]).value(), 2);
  EXPECT_DOUBLE_EQ(made.speed_up(made.rows[2]).value(), 1);
  EXPECT_FALSE(made.speed_up(made.rows[4]).has_value());
}

TEST(ModesRun, MeansAreGeometricAndOverWhatIsThere) {
  const std::vector<ModesRun> runs = {run(1), run(4)};
  EXPECT_DOUBLE_EQ(odprt_over_pdprt(runs, "odprt pilot", 2).value(), 2);
  EXPECT_FALSE(odprt_over_pdprt(runs, "odprt pilot", 4).has_value());
  EXPECT_FALSE(odprt_over_pdprt(runs, "odprt sah", 2).has_value());
  const std::string summary = summary_of(runs);
  EXPECT_NE(summary.find("55 to 64%"), std::string::npos) << summary;
  EXPECT_NE(summary.find("odprt pilot: PDPRT 100% faster"), std::string::npos) << summary;
}

TEST(ModesRun, PicturesAreHeldAgainstEachOtherBitByBit) {
  Picture a{2, 1, {0, 0, 0, 1, 1, 1}, {}, {}};
  Picture b = a;
  EXPECT_EQ(differing_pixels(a, b), 0u);
  b.rgb[3] = 1.0000001f;
  EXPECT_EQ(differing_pixels(a, b), 1u);
  b.rgb[0] = -0.0f;  // equal, but not the same bits
  EXPECT_EQ(differing_pixels(a, b), 2u);
  b.rgb.resize(3);
  EXPECT_EQ(differing_pixels(a, b), 2u);
}

TEST(ModesReport, TellsOfFailuresAndSharedCores) {
  const std::string table = table_of(run(2), {});
  EXPECT_NE(table.find("failed: odprt pilot on 4: no more memory"), std::string::npos) << table;
  EXPECT_NE(table.find("4* pdprt bag"), std::string::npos) << table;
  const Json json = json_of(std::vector<ModesRun>{run(2)}, {});
  const Json& failed = json["runs"][0]["rows"][4];
  EXPECT_EQ(failed["failure"], "no more memory");
  EXPECT_TRUE(failed["seconds"].is_null());
  EXPECT_TRUE(failed["speed_up"].is_null());
}

TEST(ModesReport, ChecksTheModelWhereQueuesHaveCores) {
  ModesRun made = run(2);
  made.model = Model{};
  for (const int queues : {2, 4}) made.model->predictions.push_back({"pdprt bag", queues, 5, 0.8});
  const std::vector<Check> checks = checks_of(made);
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_EQ(checks[0].queues, 2);
  EXPECT_DOUBLE_EQ(checks[0].error(), 0.25);
}

}  // namespace
}  // namespace kdray::bench
