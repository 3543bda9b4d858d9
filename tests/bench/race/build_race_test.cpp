// What    Builders take turns, warm up uncounted, and their times are told in the order they were given.
#include "bench/race/build_race.h"

#include <gtest/gtest.h>

#include <thread>

#include "scene/generate/displaced_sphere.h"

namespace kdray::bench {
namespace {

TEST(BuildRace, TakesTurnsAndDropsTheWarmUp) {
  std::string order;
  int run = 0;
  const TimedBuild builds[] = {[&] {
                                 order += 'a';
                                 ++run;
                                 return BuildTimes{run == 1 ? 100.0 : static_cast<double>(run), 0.5, 4};
                               },
                               [&] {
                                 order += 'b';
                                 return BuildTimes{7, 1, 9};
                               }};
  const std::vector<BuildSpreads> seconds = race_builds(builds, 3);
  EXPECT_EQ(order, "abababab");
  ASSERT_EQ(seconds.size(), 2u);
  EXPECT_EQ(seconds[0].tree.median, 3);
  EXPECT_EQ(seconds[0].tree.max, 4);
  EXPECT_EQ(seconds[0].total.median, 3.5);
  EXPECT_EQ(seconds[1].total.max, 8);
  EXPECT_EQ(seconds[1].cpu.min, 9);
}

TEST(BuildRace, ClocksTellWallAndCpuTimeApart) {
  const Stopwatch clock;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_GE(clock.wall(), 0.05);
  EXPECT_LT(clock.cpu(), clock.wall());
}

TEST(BuildRace, TimesOfABuildAreThoseOfItsParts) {
  const scene::Scene scene = generate::displaced_sphere_of(2000);
  const Stopwatch clock;
  const BuildTimes times = time_build(scene, scene::make_geometry(scene), {});
  EXPECT_GT(times.tree, 0);
  EXPECT_GT(times.flatten, 0);
  EXPECT_LE(times.tree + times.flatten, clock.wall());
  EXPECT_LE(times.cpu, clock.cpu());
}

}  // namespace
}  // namespace kdray::bench
