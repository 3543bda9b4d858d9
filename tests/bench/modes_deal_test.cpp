// What    Runs of neighbours whose largest sum is the least: by hand, and against all divisions of short rows (seed 7).
#include "bench/modes_deal.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "bench/random.h"

namespace kdray::bench {
namespace {

// Without a limit on bytes.
std::vector<std::uint32_t> deal(const std::vector<double>& costs, std::uint32_t n) {
  return bench::deal(costs, std::vector<double>(costs.size(), 1.0), n, 1e9);
}

double largest(const std::vector<double>& costs, const std::vector<std::uint32_t>& queue_of,
               std::uint32_t n) {
  std::vector<double> sums(n);
  for (std::size_t i = 0; i < costs.size(); ++i) sums.at(queue_of[i]) += costs[i];
  return *std::max_element(sums.begin(), sums.end());
}

// By trying them all.
double least(const std::vector<double>& costs, std::size_t from, std::uint32_t n) {
  double held = 0;
  for (std::size_t i = from; i < costs.size(); ++i) held += costs[i];
  if (n == 1) return held;
  double best = held;
  held = 0;
  for (std::size_t end = from; end < costs.size(); ++end) {
    held += costs[end];
    best = std::min(best, std::max(held, least(costs, end + 1, n - 1)));
  }
  return best;
}

TEST(Deal, EqualThings) {
  EXPECT_EQ(deal(std::vector<double>(6, 1.0), 3), (std::vector<std::uint32_t>{0, 0, 1, 1, 2, 2}));
}

TEST(Deal, AHeavyThingHasAQueueForItself) {
  const std::vector<double> costs{1, 1, 8, 1, 1};
  EXPECT_DOUBLE_EQ(largest(costs, deal(costs, 3), 3), 8);
}

TEST(Deal, QueuesAreLeftOver) {
  const std::vector<std::uint32_t> queue_of = deal(std::vector<double>{2, 1}, 5);
  EXPECT_EQ(queue_of, (std::vector<std::uint32_t>{0, 1}));
}

TEST(Deal, NothingCostsNothing) {
  EXPECT_EQ(deal(std::vector<double>(3, 0.0), 2).size(), 3u);
  EXPECT_TRUE(deal(std::vector<double>{}, 2).empty());
}

TEST(Deal, NoQueueHoldsMoreThanItMay) {
  const std::vector<double> costs{9, 1, 1, 1, 1, 1}, bytes(6, 10.0);
  EXPECT_EQ(bench::deal(costs, bytes, 2, 60), (std::vector<std::uint32_t>{0, 1, 1, 1, 1, 1}));
  EXPECT_EQ(bench::deal(costs, bytes, 2, 40), (std::vector<std::uint32_t>{0, 0, 1, 1, 1, 1}));
}

TEST(Deal, RaisesALimitThatCannotBeKept) {
  const std::vector<double> ones(4, 1.0);
  EXPECT_EQ(bench::deal(ones, std::vector<double>(4, 10.0), 2, 1), (std::vector<std::uint32_t>{0, 0, 1, 1}));
}

TEST(Deal, IsTheBestOfAllDivisions) {
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    std::vector<double> costs(1 + random.bits() % 9);
    for (double& cost : costs) cost = random.bits() % 4 == 0 ? 0 : random.unit();
    const auto n = static_cast<std::uint32_t>(1 + random.bits() % 4);
    const std::vector<std::uint32_t> queue_of = deal(costs, n);
    EXPECT_TRUE(std::is_sorted(queue_of.begin(), queue_of.end()));
    EXPECT_NEAR(largest(costs, queue_of, n), least(costs, 0, n), 1e-9);
  }
}

}  // namespace
}  // namespace kdray::bench
