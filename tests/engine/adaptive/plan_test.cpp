// Prices: classes keep their order and hold a price to a few percent; the limit is the highest that will do,
// found by trying all.
#include "engine/adaptive/plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kdray::adaptive {
namespace {

TEST(Prices, AClassHoldsItsPrice) {
  float price = 1e-30f;
  std::uint32_t last = 0;
  for (; price < 1e30f; price *= 1.01f) {
    const std::uint32_t number = Prices::class_of(price);
    ASSERT_LT(number, Prices::kClasses);
    EXPECT_GE(number, last);
    EXPECT_NEAR(Prices::price_of(number) / price, 1, 0.07);
    last = number;
  }
  EXPECT_EQ(Prices::class_of(0), 0u);
  EXPECT_EQ(Prices::price_of(0), 0);
}

Prices random_prices(std::mt19937& engine, int n) {
  Prices prices;
  for (int i = 0; i < n; ++i) {
    const float price = std::exp(std::normal_distribution<float>(-10, 3)(engine));
    prices.add(static_cast<int>(engine() % kLevels), Prices::class_of(price));
  }
  return prices;
}

TEST(Prices, TheLimitIsTheHighestThatWillDo) {
  std::mt19937 engine(1);  // seed 1
  for (int n = 0; n < 20; ++n) {
    const Prices prices = random_prices(engine, 300);
    const double all = prices.sum(), least = prices.sum_for(0);
    for (const double share : {0.9, 0.5, 0.2}) {
      const double wanted = least + share * (all - least);
      if (wanted < 1.1 * least) continue;
      const std::uint32_t limit = prices.limit_for(wanted);
      EXPECT_LE(prices.sum_for(limit), wanted);
      EXPECT_GT(prices.sum_for(limit + 1), wanted);
    }
  }
}

TEST(Prices, WhatCannotBeHadIsComeCloseTo) {
  std::mt19937 engine(2);  // seed 2
  const Prices prices = random_prices(engine, 300);
  EXPECT_LE(prices.sum_for(prices.limit_for(0)), 1.1 * prices.sum_for(0));
  EXPECT_GT(prices.limit_for(0), 0u) << "pixels of next to no error are left alone";
}

TEST(Prices, RefiningFollowsTheModel) {
  Prices prices;
  const std::uint32_t number = Prices::class_of(0.01f);
  prices.add(0, number);
  const double price = Prices::price_of(number);
  EXPECT_DOUBLE_EQ(prices.sum(), price);
  EXPECT_DOUBLE_EQ(prices.sum_for(number), price);
  EXPECT_NEAR(prices.sum_for(number - 1), price * 2 / 8, 1e-9)
      << "the centre's error is half of a sample's; 4^1.5 is 8";
  EXPECT_NEAR(prices.sum_for(0), price * 2 / 512, 1e-9) << "to 64 samples, and no further";
  const auto expect_levels = [](const Refined& r, int level) { EXPECT_EQ(r.level, level); };
  expect_levels(refined(0, price, price), 0);
  expect_levels(refined(0, price, 0.99 * price), 1);
  expect_levels(refined(0, price, 0), kLevels - 1);
  expect_levels(refined(0, price, 0, 2), 2);
  expect_levels(refined(kLevels - 1, price, 0), kLevels - 1);
  prices.remove(0, number);
  EXPECT_EQ(prices.sum(), 0);
}

}  // namespace
}  // namespace kdray::adaptive
