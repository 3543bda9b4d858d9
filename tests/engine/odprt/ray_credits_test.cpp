// What    Credits for rays: they never let a level pass its capacity, whatever queues do with them; some
//         queue can always go on; and when all has ended nothing is left.
// Shape   A random play: queues take credits, make and end rays as a launch may, and settle in any order.
#include "engine/odprt/ray_credits.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace kdray::test {
namespace {

using odprt::RayCredits;

constexpr std::uint64_t kCreditsSeed = 17;
constexpr std::size_t kSlices = 3, kQueues = 4;
constexpr std::uint32_t kDepth = 5;

struct Play {
  std::mt19937_64 random{kCreditsSeed};
  std::vector<std::uint32_t> capacity = {30, 24, 16, 16, 8, 8}, least = {3, 1, 2, 2, 2, 2};
  RayCredits ray_credits{kSlices, capacity, least, kQueues};
  // Rays alive by slice and level, as the play knows them; those that a running queue is to settle are in it.
  std::vector<std::vector<std::uint32_t>> alive{kSlices, std::vector<std::uint32_t>(kDepth + 1)};
  std::vector<std::vector<layout::Credits>> granted{kQueues, std::vector<layout::Credits>(kSlices)};
  std::vector<bool> running = std::vector<bool>(kQueues);

  std::uint32_t below(std::uint32_t n) { return n == 0 ? 0 : static_cast<std::uint32_t>(random() % n); }

  std::uint64_t total() const {
    std::uint64_t sum = 0;
    for (const auto& slice : alive) sum = std::accumulate(slice.begin(), slice.end(), sum);
    return sum;
  }

  // Ends some rays that are alive and makes some, as far as the credits go and what has ended allows.
  // Only rays that are settled may end elsewhere, so a queue ends rays that were alive before.
  void settle(std::size_t queue) {
    std::vector<layout::Traffic> traffic(kSlices);
    for (std::size_t s = 0; s < kSlices; ++s)
      for (std::uint32_t level = 0; level <= kDepth; ++level) {
        const std::uint32_t ended = below(alive[s][level] + 1),
                            made = below(granted[queue][s].rays[level] + ended + 1);
        traffic[s].made[level] = made;
        traffic[s].ended[level] = ended;
        alive[s][level] += made - ended;
        ASSERT_LE(alive[s][level], capacity[level]);
      }
    ray_credits.settle(queue, traffic);
    running[queue] = false;
  }
};

TEST(RayCredits, NoLevelPassesItsCapacity) {
  Play play;
  std::uint64_t most = 0;
  for (int step = 0; step < 5000; ++step) {
    const std::size_t queue = play.below(kQueues);
    if (play.running[queue]) {
      play.settle(queue);
    } else {
      play.ray_credits.grant(queue, play.granted[queue]);
      play.running[queue] = true;
    }
    EXPECT_EQ(play.ray_credits.alive(), play.total());
    most = std::max(most, play.total());
  }
  EXPECT_GT(most, 80u);
}

TEST(RayCredits, AQueueThatIsAloneIsGrantedWhatOneRayMayMake) {
  Play play;
  for (std::size_t queue = 0; queue < kQueues; ++queue) {
    play.ray_credits.grant(queue, play.granted[queue]);
    for (std::size_t s = 0; s < kSlices; ++s)
      for (std::uint32_t level = 0; level <= kDepth; ++level)
        EXPECT_GE(play.granted[queue][s].rays[level], play.least[level]);
    play.ray_credits.settle(queue, std::vector<layout::Traffic>(kSlices));
  }
}

TEST(RayCredits, WhatWasGrantedComesBack) {
  Play play;
  for (int round = 0; round < 100; ++round) {
    for (std::size_t queue = 0; queue < kQueues; ++queue) play.ray_credits.grant(queue, play.granted[queue]);
    for (std::size_t s = 0; s < kSlices; ++s)
      for (std::uint32_t level = 0; level <= kDepth; ++level) {
        std::uint32_t sum = 0;
        for (std::size_t queue = 0; queue < kQueues; ++queue) sum += play.granted[queue][s].rays[level];
        EXPECT_LE(sum, play.capacity[level]);
        EXPECT_GE(sum, play.capacity[level] / 2) << "capacity that nobody can use";
      }
    for (std::size_t queue = 0; queue < kQueues; ++queue)
      play.ray_credits.settle(queue, std::vector<layout::Traffic>(kSlices));
  }
  EXPECT_EQ(play.ray_credits.alive(), 0u);
}

}  // namespace
}  // namespace kdray::test
