// What    Medians and spreads, by hand.
#include "bench/measure/spread.h"

#include <gtest/gtest.h>

namespace kdray::bench {
namespace {

TEST(Spread, OddEvenOneNone) {
  const Spread odd = spread_of({5, 1, 3});
  EXPECT_EQ(odd.median, 3);
  EXPECT_EQ(odd.min, 1);
  EXPECT_EQ(odd.max, 5);
  EXPECT_EQ(spread_of({4, 1, 2, 100}).median, 3);
  const Spread one = spread_of({7});
  EXPECT_TRUE(one.median == 7 && one.min == 7 && one.max == 7);
  EXPECT_EQ(spread_of({}).median, 0);
}

TEST(Spread, TheSlowestGivesTheLowestRate) {
  const Spread rate = mrays_per_s(2'000'000, {.median = 0.5, .min = 0.25, .max = 1});
  EXPECT_EQ(rate.median, 4);
  EXPECT_EQ(rate.min, 2);
  EXPECT_EQ(rate.max, 8);
  EXPECT_EQ(mrays_per_s(10, Spread{}).median, 0);
}

}  // namespace
}  // namespace kdray::bench
