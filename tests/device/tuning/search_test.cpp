// What    Searches on a synthetic machine: the optimum within the budget, noise, wrong candidates, and when a
//         search ends.
#include <gtest/gtest.h>

#include "device/tuning/search.h"
#include "device/tuning/synthetic.h"
#include "kdray/error.h"

namespace kdray::test {
namespace {

const Synthetic::Factors kFactors = {{"batch", {{256, 1.1}, {1024, 0.92}, {2048, 0.97}}},
                                     {"tile", {{16, 0.9}, {64, 1.2}}},
                                     {"packets", {{4, 0.85}, {16, 1.3}}},
                                     {"spread", {{18, 1.05}, {70, 0.94}}}};
constexpr Tuning kOptimum = {.tile = 16, .batch = 1024, .packets = 4, .spread = 70};

TEST(Search, FindsTheOptimumWithinTheBudgetAndWithFewerFramesThanASweep) {
  Synthetic machine(kFactors);
  const tuning::Lab lab = machine.lab();
  const tuning::Found found = tuning::search(lab, {}, {.budget = 20});
  EXPECT_EQ(found.best, kOptimum) << tuning::in_words(found.best);
  EXPECT_FALSE(found.kept_start);
  EXPECT_NEAR(found.ratio, 0.92 * 0.9 * 0.85 * 0.94, 0.01);
  EXPECT_LE(machine.now, 20);
  EXPECT_LT(machine.frames, 400)
      << "a sweep of four settings alone would take 4*3*3*3 candidates of 9 rounds";
}

TEST(Search, FindsItInNoiseForMostSeedsAndIsNeverWorseThanTheStart) {
  int near = 0;
  constexpr unsigned kSeeds = 50;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    Synthetic machine(kFactors, 0.02, seed);
    const tuning::Lab lab = machine.lab();
    const tuning::Found found = tuning::search(lab, {}, {.budget = 30});
    const double ratio = machine.exact(found.best) / machine.exact({});
    EXPECT_LE(ratio, 1.02) << "seed " << seed << ": " << tuning::in_words(found.best);
    near += ratio < 1.05 * machine.exact(kOptimum) / machine.exact({});
  }
  EXPECT_GE(near, 45) << "of " << kSeeds;
}

TEST(Search, KeepsTheStartWhereNothingIsFaster) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    Synthetic machine({{"batch", {{256, 1.1}, {1024, 1.05}, {2048, 1.2}}}}, 0.02, seed);
    const tuning::Lab lab = machine.lab();
    const tuning::Found found = tuning::search(lab, {}, {});
    EXPECT_LE(machine.exact(found.best) / machine.exact({}), 1.02) << "seed " << seed;
    EXPECT_TRUE(!found.kept_start || found.best == Tuning{}) << "seed " << seed;
  }
}

TEST(Search, NeverTakesAWrongCandidate) {
  Synthetic machine(kFactors);
  machine.wrong = [](const Tuning& t) { return t.packets == 4; };
  const tuning::Lab lab = machine.lab();
  const tuning::Found found = tuning::search(lab, {}, {.budget = 20});
  EXPECT_EQ(found.best.packets, 0);
  EXPECT_EQ(found.best.batch, 1024);
  EXPECT_FALSE(machine.timed_wrong);
}

TEST(Search, RefusesAWrongStart) {
  Synthetic machine(kFactors);
  machine.wrong = [](const Tuning& t) { return t == Tuning{}; };
  const tuning::Lab lab = machine.lab();
  EXPECT_THROW(tuning::search(lab, {}, {}), Error);
}

TEST(Search, TriesNothingThatTakesLongerThanItCanSave) {
  Synthetic machine(kFactors);
  const tuning::Lab lab = machine.lab();
  const tuning::Found found = tuning::search(lab, {}, {.budget = 1000, .frames = 10});
  EXPECT_TRUE(found.steps.empty());
  EXPECT_TRUE(found.kept_start);
  EXPECT_NE(found.ended_by.find("take longer"), std::string::npos) << found.ended_by;
  EXPECT_LT(machine.now, 2);
}

TEST(Search, ASmallBudgetGoesToWhatNeedsNoCompiler) {
  Synthetic machine(kFactors);
  machine.compile = 5;
  const tuning::Lab lab = machine.lab();
  const tuning::Found found = tuning::search(lab, {}, {.budget = 12});
  EXPECT_EQ(found.best.batch, 1024);
  EXPECT_EQ(found.best.tile, 16);
  EXPECT_EQ(found.best.packets, 0);
  EXPECT_LE(machine.now, 12);
}

TEST(Search, LooksOnlyAtWhatTheScheduleUses) {
  Synthetic machine(kFactors);
  const tuning::Lab lab = machine.lab();
  for (const tuning::Step& step : tuning::search(lab, {}, {.global = true}).steps)
    EXPECT_TRUE(step.setting->global) << step.setting->name;
}

}  // namespace
}  // namespace kdray::test
