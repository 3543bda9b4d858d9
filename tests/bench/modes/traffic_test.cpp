// What    Journeys of rays whose paths are written by hand: who is asked, in what order, how often, and where
//         rays end.
#include "bench/modes/traffic.h"

#include <gtest/gtest.h>

namespace kdray::bench {
namespace {

const Rates kRates{1, 100};

std::vector<Hop> way(const std::vector<Visit>& path, bool hit, LifeKind kind = LifeKind::reflected) {
  Paths paths;
  paths.visits = path;
  paths.first = {0, 0, path.size()};
  std::vector<LifeRay> lives(2);
  lives[1].hit = hit, lives[1].kind = kind;
  lives[1].parent = 0;  // of an eye ray that meets nothing and begins on queue 0
  return make_traffic(lives, paths, 9, kRates, 1).journeys[1].hops;
}

void expect_hops(const std::vector<Hop>& hops, const std::vector<Hop>& wanted) {
  ASSERT_EQ(hops.size(), wanted.size());
  for (std::size_t i = 0; i < hops.size(); ++i) {
    EXPECT_EQ(hops[i].queue, wanted[i].queue) << i;
    EXPECT_DOUBLE_EQ(hops[i].seconds, wanted[i].seconds) << i;
  }
}

TEST(TrafficOfRays, TheDirectoryIsWalkedByWhoeverHasTheRay) {
  expect_hops(way({{kDirectory, 1}, {3, 2}, {kDirectory, 4}, {5, 8}, {kDirectory, 16}}, false),
              {{0, 1}, {3, 6}, {5, 24}});
}

TEST(TrafficOfRays, AQueueIsAskedOnceForAllThatItHolds) {
  expect_hops(way({{3, 1}, {5, 2}, {3, 4}}, false), {{0, 0}, {3, 5}, {5, 2}});
  expect_hops(way({{0, 1}, {5, 2}, {0, 4}}, false), {{0, 5}, {5, 2}});
}

TEST(TrafficOfRays, TheFirstStopIsAskedInItsTurn) {
  expect_hops(way({{5, 2}, {0, 4}}, false), {{0, 0}, {5, 2}, {0, 4}});
}

TEST(TrafficOfRays, AHitIsShadedByWhoFoundIt) {
  expect_hops(way({{3, 1}, {5, 2}}, true), {{0, 0}, {3, 1}, {5, 102}});
  expect_hops(way({{3, 1}, {5, 2}, {3, 4}}, true), {{0, 0}, {3, 5}, {5, 2}, {3, 100}});
}

TEST(TrafficOfRays, AShadowRayEndsWithTheFirstThatFindsSomething) {
  expect_hops(way({{3, 1}, {5, 2}, {3, 4}}, true, LifeKind::shadow), {{0, 0}, {3, 5}});
  expect_hops(way({{3, 1}, {5, 2}, {3, 4}}, false, LifeKind::shadow), {{0, 0}, {3, 5}, {5, 2}});
}

TEST(TrafficOfRays, OneThatMeetsNothingEndsWhereItBegins) {
  expect_hops(way({}, false), {{0, 0}});
  expect_hops(way({{kDirectory, 2}}, false), {{0, 2}});
}

TEST(TrafficOfRays, WhatAllHoldIsShadedWhereTheRayIs) {
  expect_hops(way({{kDirectory, 2}}, true), {{0, 102}});
  expect_hops(way({{3, 1}, {kDirectory, 2}}, true), {{0, 0}, {3, 103}});
}

TEST(TrafficOfRays, EyeRaysBeginWhereTheyAreAskedAndChildrenWhereTheHitIs) {
  Paths paths;
  paths.visits = {{2, 1}};
  paths.first = {0, 1, 1, 1};
  std::vector<LifeRay> lives(3);
  lives[0].hit = true;
  lives[2].parent = 0, lives[2].depth = 2;
  const Traffic traffic = make_traffic(lives, paths, 4, kRates, 8);
  EXPECT_EQ(traffic.first, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(traffic.journeys[0].next, std::vector<std::uint32_t>{2});
  expect_hops(traffic.journeys[0].hops, {{2, 8 * 101}});
  expect_hops(traffic.journeys[1].hops, {{1, 0}});
  expect_hops(traffic.journeys[2].hops, {{2, 0}});
  EXPECT_EQ(traffic.journeys[2].depth, 2u);
}

}  // namespace
}  // namespace kdray::bench
