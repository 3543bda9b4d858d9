// Whether all ranks are done: against ranks that are only imagined, with work that wanders, in any order.
#include "engine/odprt/termination_detector.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>

namespace kdray::odprt {
namespace {

TEST(TerminationDetectorTest, TwoWavesThatAgree) {
  TerminationDetector detector(2);
  EXPECT_FALSE(detector.is_asking());
  detector.begin_wave();
  EXPECT_TRUE(detector.answer(0, 1, {3, 2}));
  EXPECT_FALSE(detector.answer(0, 1, {3, 2}));  // has answered
  EXPECT_FALSE(detector.answer(1, 2, {1, 2}));  // another wave
  EXPECT_TRUE(detector.answer(1, 1, {1, 2}));
  EXPECT_FALSE(detector.is_asking());
  EXPECT_FALSE(detector.is_over());  // one wave alone
  detector.begin_wave();
  detector.answer(1, 2, {1, 2});
  detector.answer(0, 2, {3, 2});
  EXPECT_TRUE(detector.is_over());
}

TEST(TerminationDetectorTest, NotWhileSomethingIsOnItsWay) {
  TerminationDetector detector(2);
  for (int wave = 0; wave < 2; ++wave) {
    detector.begin_wave();
    detector.answer(0, detector.wave(), {1, 0});
    detector.answer(1, detector.wave(), {0, 0});
  }
  EXPECT_FALSE(detector.is_over());
  detector.begin_wave();
  detector.answer(0, 3, {1, 0});
  detector.answer(1, 3, {0, 1});
  EXPECT_FALSE(detector.is_over());  // something has happened since the last wave
  detector.begin_wave();
  detector.answer(0, 4, {1, 0});
  detector.answer(1, 4, {0, 1});
  EXPECT_TRUE(detector.is_over());
}

// Ranks with work that each may send on, and answers that may come late.
TEST(TerminationDetectorTest, NeverTooEarlyAndAlwaysInTheEnd) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t n = 1 + random() % 6;
    struct Rank {
      int work = 0;
      WorkMessages count;
      std::uint32_t asked = 0;
    };
    std::vector<Rank> ranks(n);
    ranks[random() % n].work = 40;
    std::vector<std::size_t> on_their_way;  // to whom
    std::vector<std::pair<std::size_t, std::uint32_t>> asking;
    struct Answer {
      std::size_t from;
      std::uint32_t wave;
      WorkMessages count;
    };
    std::vector<Answer> answers;
    TerminationDetector detector(n);
    int steps = 0;
    for (; !detector.is_over() && steps < 100000; ++steps) {
      Rank& rank = ranks[random() % n];
      if (rank.work > 0) {
        --rank.work;
        if (random() % 3 != 0) {
          on_their_way.push_back(random() % n);
          ++rank.count.sent;
        }
      } else if (rank.asked > 0) {
        answers.push_back({static_cast<std::size_t>(&rank - ranks.data()), rank.asked, rank.count});
        rank.asked = 0;
      }
      const auto any = [&](auto& list, auto take) {
        if (list.empty() || random() % 2 == 0) return;
        std::swap(list[random() % list.size()], list.back());
        auto item = list.back();
        list.pop_back();
        take(item);
      };
      any(on_their_way, [&](std::size_t to) { ++ranks[to].work, ++ranks[to].count.received; });
      any(asking, [&](const auto& asked) { ranks[asked.first].asked = asked.second; });
      any(answers, [&](const Answer& a) { EXPECT_TRUE(detector.answer(a.from, a.wave, a.count)); });
      if (!detector.is_asking() && !detector.is_over()) {
        detector.begin_wave();
        for (std::size_t i = 0; i < n; ++i) asking.emplace_back(i, detector.wave());
      }
    }
    EXPECT_LT(steps, 100000);
    EXPECT_TRUE(on_their_way.empty());
    for (const Rank& rank : ranks) EXPECT_EQ(rank.work, 0);
  }
}

}  // namespace
}  // namespace kdray::odprt
