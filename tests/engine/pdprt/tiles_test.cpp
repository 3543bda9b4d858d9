// Every tile comes to one queue, whatever the division, the number of queues and threads, and which of them
// fail; static shares are equal; and a bag evens out what shares can't.
#include "engine/pdprt/tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <numeric>
#include <random>
#include <thread>

namespace kdray::pdprt {
namespace {

constexpr Division kDivisions[] = {Division::bag, Division::contiguous, Division::interleaved};

std::vector<layout::u32> numbered(std::size_t n) {
  std::vector<layout::u32> tiles(n);
  std::iota(tiles.begin(), tiles.end(), 0u);
  return tiles;
}

TEST(Tiles, EachComesToOneQueueInEveryDivision) {
  const unsigned seed = 1;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const auto pick = [&](std::size_t lo, std::size_t hi) {
    return std::uniform_int_distribution<std::size_t>(lo, hi)(random);
  };
  for (const Division division : kDivisions) {
    for (int round = 0; round < 300; ++round) {
      const std::size_t n = pick(1, 500), n_queues = pick(1, 9);
      Tiles tiles(numbered(n), division, n_queues);
      std::vector<int> times(n, 0);
      std::size_t n_taken = 0;
      while (n_taken < n) {
        const std::size_t wanted = pick(1, 50);
        const auto taken = tiles.take(pick(0, n_queues - 1), {.most = wanted});
        for (const layout::u32 tile : taken) ++times[tile];
        n_taken += taken.size();
        if (division == Division::bag) {
          EXPECT_LE(taken.size(), wanted);
        }
      }
      EXPECT_EQ(std::count(times.begin(), times.end(), 1), static_cast<long>(n));
      for (std::size_t q = 0; q < n_queues; ++q) tiles.done(q);
      EXPECT_FALSE(tiles.wait(0));
    }
  }
}

TEST(Tiles, SharesAreEqualRunsOrEveryNth) {
  constexpr std::size_t kTiles = 103, kQueues = 4;
  Tiles runs(numbered(kTiles), Division::contiguous, kQueues);
  Tiles nth(numbered(kTiles), Division::interleaved, kQueues);
  for (std::size_t q = 0; q < kQueues; ++q) {
    const auto run = runs.take(q, {}), comb = nth.take(q, {});
    EXPECT_NEAR(static_cast<double>(run.size()), kTiles / 4.0, 1);
    EXPECT_NEAR(static_cast<double>(comb.size()), kTiles / 4.0, 1);
    for (std::size_t i = 1; i < run.size(); ++i) EXPECT_EQ(run[i], run[i - 1] + 1);
    for (std::size_t i = 0; i < comb.size(); ++i) EXPECT_EQ(comb[i], q + i * kQueues);
  }
}

TEST(Tiles, PartsOfTheBagShrink) {
  Tiles tiles(numbered(1000), Division::bag, 2);
  EXPECT_EQ(tiles.take(0, {.most = 30}).size(), 30u);
  EXPECT_EQ(tiles.take(1, {.most = 1000}).size(), 970u / 8);
  std::size_t last = 1000;
  for (std::size_t n = tiles.take(0, {.most = 1000, .least = 3}).size(); n > 0;
       n = tiles.take(0, {.most = 1000, .least = 3}).size()) {
    EXPECT_TRUE(n <= last && (n >= 3 || tiles.take(1, {}).empty())) << n;
    last = n;
  }
}

// What a queue still has counts: at the end none takes more while others have nothing.
TEST(Tiles, NobodyTakesAheadOfTheOthersAtTheEnd) {
  Tiles tiles(numbered(80), Division::bag, 2);
  EXPECT_EQ(tiles.take(0, {.most = 100}).size(), 10u);
  EXPECT_EQ(tiles.take(0, {.most = 100, .ahead = 10}).size(), 0u);
  EXPECT_EQ(tiles.take(0, {.most = 100, .ahead = 5}).size(), 3u);  // an eighth of 70 is 8
  EXPECT_EQ(tiles.take(0, {.most = 5, .ahead = 4}).size(), 1u);
}

// The device may still be reading what a queue took when it takes more.
TEST(Tiles, WhatWasTakenStaysWhereItIs) {
  Tiles tiles(numbered(1000), Division::bag, 1);
  const auto first = tiles.take(0, {.most = 10});
  while (!tiles.take(0, {.most = 10}).empty()) continue;
  EXPECT_EQ(tiles.taken(0).data(), first.data());
  EXPECT_EQ(tiles.taken(0).size(), 1000u);
}

TEST(Tiles, ThoseOfAFailedQueueGoToOneThatWaits) {
  for (const Division division : kDivisions) {
    Tiles tiles(numbered(100), division, 2);
    const std::size_t n = tiles.take(1, {.most = 40}).size();
    EXPECT_GT(n, 0u);
    std::vector<int> times(100, 0);
    std::jthread other([&] {
      while (tiles.wait(0)) {
        while (!tiles.take(0, {.most = 7}).empty()) continue;
        for (const layout::u32 tile : tiles.taken(0)) ++times[tile];
        tiles.done(0);
      }
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_EQ(tiles.give_back(1), n);
    other.join();
    EXPECT_EQ(std::count(times.begin(), times.end(), 1), 100);
  }
}

TEST(Tiles, LeavingWakesWhoWaits) {
  Tiles tiles(numbered(3), Division::bag, 2);
  while (!tiles.take(1, {}).empty()) continue;
  std::jthread waiting([&] { EXPECT_FALSE(tiles.wait(0)); });
  tiles.leave();
  EXPECT_TRUE(tiles.left());
}

// What was taken when the tiles are closed is done, the rest is told, and nothing is both, however often they
//      are closed and whoever fails.
TEST(Tiles, ClosingLeavesWhatNobodyHasTaken) {
  constexpr std::size_t kTiles = 1000, kQueues = 4;
  for (const Division division : kDivisions) {
    for (const std::size_t before : {0u, 3u, 300u}) {
      Tiles tiles(numbered(kTiles), division, kQueues, true);
      std::vector<int> times(kTiles);
      for (std::size_t i = 0; i < before; ++i) tiles.take(i % kQueues, {.most = 2});
      tiles.close();
      tiles.give_back(0);
      tiles.close();
      for (std::size_t q = 1; q < kQueues; ++q) {
        while (!tiles.take(q, {.most = 5}).empty()) continue;
        for (const layout::u32 tile : tiles.taken(q)) ++times[tile];
        tiles.done(q);
      }
      EXPECT_FALSE(tiles.wait(1));
      for (const layout::u32 tile : tiles.left_over()) ++times[tile];
      EXPECT_TRUE(std::all_of(times.begin(), times.end(), [](int n) { return n == 1; }));
      EXPECT_FALSE(tiles.left_over().empty());
    }
  }
}

// Queues that fail at any time, all but one of them.
TEST(Tiles, ManyThreadsAndFailures) {
  constexpr std::size_t kTiles = 20000, kQueues = 6;
  for (const Division division : kDivisions) {
    Tiles tiles(numbered(kTiles), division, kQueues);
    std::vector<std::atomic<int>> times(kTiles);
    {
      std::vector<std::jthread> threads;
      for (std::size_t q = 0; q < kQueues; ++q)
        threads.emplace_back([&, q] {
          std::mt19937 random(static_cast<unsigned>(q));
          for (int lists = 0; tiles.wait(q); ++lists) {
            for (int i = 0; i < 5; ++i) tiles.take(q, {.most = 1 + random() % 40});
            if (q > 0 && lists >= 3 && random() % 4 == 0) {
              tiles.give_back(q);
              return;
            }
            for (const layout::u32 tile : tiles.taken(q)) ++times[tile];
            tiles.done(q);
          }
        });
    }
    EXPECT_TRUE(std::all_of(times.begin(), times.end(), [](const auto& n) { return n == 1; }));
  }
}

// Queues whose time is counted, not measured: when the last one ends, if tile i takes cost(i).
double simulated(Division division, std::size_t n_tiles, const std::function<double(std::size_t)>& cost) {
  constexpr std::size_t kQueues = 2;
  Tiles tiles(numbered(n_tiles), division, kQueues);
  double clock[kQueues] = {};
  bool working[kQueues] = {true, true};
  while (working[0] || working[1]) {
    const std::size_t q = !working[1] || (working[0] && clock[0] <= clock[1]) ? 0 : 1;
    const auto taken = tiles.take(q, {.most = 8});
    working[q] = !taken.empty();
    for (const layout::u32 tile : taken) clock[q] += cost(tile);
  }
  return std::max(clock[0], clock[1]);
}

TEST(Tiles, ABagEvensOutALopsidedPicture) {
  const auto cost = [](std::size_t tile) { return tile < 250 ? 10.0 : 1.0; };  // 3250 in all
  EXPECT_EQ(simulated(Division::contiguous, 1000, cost), 2750);
  EXPECT_LE(simulated(Division::bag, 1000, cost), 1625 + 10);
}

TEST(TilesInTime, AreThoseOfTheTimeThatIsLeftAndOneForEachSlice) {
  EXPECT_EQ(tiles_in_time(10, 2, 100, 64), 400u);
  EXPECT_EQ(tiles_in_time(10, 9.9, 100, 64), 64u);
  EXPECT_EQ(tiles_in_time(10, 0, 0, 64), 64u) << "nothing is known yet";
  EXPECT_EQ(tiles_in_time(1, 5, 100, 8), 8u) << "the time is over";
  EXPECT_GE(tiles_in_time(1e300, 1e-300, 1000, 8), std::size_t{1} << 40);
}

}  // namespace
}  // namespace kdray::pdprt
