// What    Races on a synthetic machine: the fastest wins, the slow are dropped early, the wrong are never
//         timed.
#include <gtest/gtest.h>

#include "device/tuning/synthetic.h"

namespace kdray::test {
namespace {

std::vector<tuning::Rival> rivals(std::initializer_list<int> batches) {
  std::vector<tuning::Rival> all;
  for (const int batch : batches) all.push_back({Tuning{.batch = batch}});
  return all;
}

constexpr tuning::RaceLimits kLimits = {9, 1e9};

TEST(Race, TheFastestWinsAndTheClearlySlowTakeTwoRounds) {
  Synthetic machine({{"batch", {{256, 1.5}, {1024, 0.9}, {2048, 0.8}}}}, 0.01, 7);
  const tuning::Lab lab = machine.lab();
  std::vector<tuning::Rival> all = rivals({256, 1024, 2048});
  tuning::race(lab, {}, all, kLimits);
  EXPECT_EQ(all[0].verdict, tuning::Verdict::slower);
  EXPECT_EQ(all[0].ratios.size(), 2u);
  EXPECT_EQ(all[1].verdict, tuning::Verdict::no_better);
  EXPECT_LT(all[1].ratios.size(), 9u) << "the slower half is dropped";
  EXPECT_EQ(all[2].verdict, tuning::Verdict::won);
  EXPECT_NEAR(all[2].ratio(), 0.8, 0.03) << "a drift of 30 % is not noticed";
}

TEST(Race, AWrongOutputIsNeverTimed) {
  Synthetic machine({{"batch", {{1024, 0.5}, {2048, 0.9}}}});
  machine.wrong = [](const Tuning& t) { return t.batch == 1024; };
  const tuning::Lab lab = machine.lab();
  std::vector<tuning::Rival> all = rivals({1024, 2048});
  tuning::race(lab, {}, all, kLimits);
  EXPECT_EQ(all[0].verdict, tuning::Verdict::wrong);
  EXPECT_TRUE(all[0].ratios.empty());
  EXPECT_FALSE(machine.timed_wrong);
  EXPECT_EQ(all[1].verdict, tuning::Verdict::won);
}

TEST(Race, NoiseAloneRarelyWins) {
  int won = 0;
  constexpr unsigned kRaces = 200;
  for (unsigned seed = 0; seed < kRaces; ++seed) {
    Synthetic machine({}, 0.03, seed);
    const tuning::Lab lab = machine.lab();
    std::vector<tuning::Rival> all = rivals({1024});
    tuning::race(lab, {}, all, kLimits);
    won += all[0].verdict == tuning::Verdict::won;
  }
  EXPECT_LE(won, 30) << "of " << kRaces;
}

TEST(Race, EndsInTimeAndThenNobodyWins) {
  Synthetic machine({{"batch", {{1024, 0.5}}}});
  const tuning::Lab lab = machine.lab();
  std::vector<tuning::Rival> all = rivals({1024});
  tuning::race(lab, {}, all, {9, 0.05});
  EXPECT_LE(all[0].ratios.size(), 3u);
  EXPECT_EQ(all[0].verdict, tuning::Verdict::no_better);
}

TEST(Race, TheWorstSceneIsTheLargestMedian) {
  tuning::Rival rival;
  rival.of_scenes = {{0.8, 1.1}, {0.7, 1.2}, {0.9, 1.0}};
  EXPECT_DOUBLE_EQ(rival.worst_scene(), 1.1);
}

}  // namespace
}  // namespace kdray::test
