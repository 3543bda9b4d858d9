// What    The Pareto front: against the definition, for all points of random sets, and in the cases where one
//         may slip.
#include "bench/accuracy/answers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace kdray::bench {
namespace {

using Front = std::vector<std::size_t>;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Front front_of(const std::vector<Cost>& costs) {
  return pareto_front(costs);
}

TEST(ParetoFront, OfNothingAndOfOnePoint) {
  EXPECT_EQ(front_of({}), Front{});
  EXPECT_EQ(front_of({{3, 4}}), Front{0});
  EXPECT_EQ(front_of({{0, 0}}), Front{0});
}

TEST(ParetoFront, GoesFromTheFastestToTheBest) {
  EXPECT_EQ(front_of({{4, 1}, {1, 4}, {3, 3}, {2, 2}}), (Front{1, 3, 0}));
}

TEST(ParetoFront, OfTiesTakesTheBetterAndOfEqualsTheFirst) {
  EXPECT_EQ(front_of({{1, 5}, {1, 4}}), Front{1});          // as fast, nearer
  EXPECT_EQ(front_of({{2, 5}, {1, 5}}), Front{1});          // as near, faster
  EXPECT_EQ(front_of({{1, 5}, {1, 5}, {1, 5}}), Front{0});  // equal
  EXPECT_EQ(front_of({{1, 5}, {2, 0}, {3, 0}}), (Front{0, 1}));
}

TEST(ParetoFront, HasNothingThatIsNotFinite) {
  EXPECT_EQ(front_of({{kNan, 0}, {0, kNan}, {kInfinity, 0}, {0, kInfinity}, {1, 1}}), Front{4});
  EXPECT_EQ(front_of({{kNan, kNan}}), Front{});
}

TEST(ParetoFront, IsWhatNoOtherPointBeats) {
  std::mt19937 random(20);
  for (int set = 0; set < 200; ++set) {
    std::vector<Cost> costs(1 + random() % 30);
    for (Cost& c : costs) c = {static_cast<double>(random() % 12), static_cast<double>(random() % 12)};
    const Front front = front_of(costs);
    for (std::size_t i = 0; i < costs.size(); ++i) {
      bool beaten = false;
      for (std::size_t j = 0; j < costs.size(); ++j) {
        const bool no_worse = costs[j].seconds <= costs[i].seconds && costs[j].error <= costs[i].error;
        const bool better = costs[j].seconds < costs[i].seconds || costs[j].error < costs[i].error;
        beaten |= no_worse && (better || j < i);
      }
      EXPECT_EQ(std::count(front.begin(), front.end(), i), beaten ? 0 : 1) << "set " << set << ", " << i;
    }
  }
}

}  // namespace
}  // namespace kdray::bench
