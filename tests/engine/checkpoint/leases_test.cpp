// Leases: one owner at a time, whoever asks and how many at once; those of an owner that is gone run out, by
// the watcher's own clock.
#include "engine/checkpoint/leases.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <numeric>
#include <thread>
#include <vector>

#include "base/timer.h"
#include "support/folder.h"
#include "support/patience.h"

namespace kdray::checkpoint {
namespace {

using test::Folder;
using namespace std::chrono_literals;

constexpr double kLease = 0.3;

TEST(CreateOnce, OneOfManyMakesIt) {
  const Folder folder;
  for (int i = 0; i < 50; ++i) {
    std::atomic<int> n_made = 0;
    const std::filesystem::path file = folder / ("file" + std::to_string(i));
    {
      std::vector<std::jthread> threads;
      for (int t = 0; t < 8; ++t)
        threads.emplace_back([&, t] { n_made += create_once(file, "by " + std::to_string(t)) ? 1 : 0; });
    }
    ASSERT_EQ(n_made, 1);
    ASSERT_EQ(read_small(file, 100).substr(0, 3), "by ");
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}),
            50);  // nothing else is left
}

TEST(Leases, EachThingHasOneOwner) {
  const Folder folder;
  constexpr std::size_t kThings = 40;
  std::vector<std::atomic<int>> owners(kThings);
  std::vector<std::jthread> threads;
  for (int t = 0; t < 6; ++t)
    threads.emplace_back([&] {
      Heartbeat heartbeat(folder.path(), new_owner(), 10);
      Leases leases(folder.path(), "lot-0", 0, kThings, heartbeat);
      leases.look();
      for (std::size_t i = 0; i < kThings; ++i)
        if (leases.is_free(i) && leases.claim(i)) ++owners[i];
      while (!leases.all_done()) {  // a process that left would free what it has
        for (std::size_t i = 0; i < kThings; ++i)
          if (leases.is_mine(i)) leases.finish(i);
        leases.look();
      }
    });
  threads.clear();
  for (const auto& n : owners) EXPECT_EQ(n, 1);
}

TEST(Leases, AProcessThatLeavesFreesWhatItHas) {
  const Folder folder;
  Heartbeat second(folder.path(), "second", 1000);
  Leases mine(folder.path(), "lot-0", 0, 3, second);
  {
    Heartbeat first(folder.path(), "first", 1000);
    Leases leases(folder.path(), "lot-0", 0, 3, first);
    EXPECT_TRUE(leases.claim(0));
    EXPECT_TRUE(leases.claim(1));
    EXPECT_TRUE(leases.finish(1));
    EXPECT_FALSE(leases.finish(1));
    mine.look();
    EXPECT_FALSE(mine.is_free(0));
    EXPECT_TRUE(mine.is_done(1));
    EXPECT_TRUE(mine.is_free(2));
    EXPECT_FALSE(mine.was_held(2));
  }
  mine.look();
  EXPECT_TRUE(mine.is_free(0));
  EXPECT_TRUE(mine.claim(0));
  EXPECT_TRUE(mine.was_held(0));
  EXPECT_TRUE(mine.is_mine(0));
}

// As SIGKILL leaves it: the file stays, and its count with it.
TEST(Leases, OneThatIsKilledLosesThemWithinALease) {
  const Folder folder;
  std::ofstream(folder / "killed.beat") << 17;
  std::ofstream(folder / "lot-0-1.0") << "killed";
  std::ofstream(folder / "lot-0-2.0") << "";  // killed between making and writing it
  Heartbeat heartbeat(folder.path(), "me", kLease);
  Leases leases(folder.path(), "lot-0", 0, 3, heartbeat);
  const Timer timer;
  leases.look();
  EXPECT_FALSE(leases.is_free(1));
  EXPECT_FALSE(leases.is_free(2));
  EXPECT_TRUE(test::comes_true([&] {
    leases.look();
    return leases.is_free(1) && leases.is_free(2);
  }));
  EXPECT_GE(timer.seconds(), kLease);
  EXPECT_TRUE(leases.claim(1));
}

TEST(Heartbeat, CountsOnByItself) {
  const Folder folder;
  const Heartbeat heartbeat(folder.path(), "me", kLease);
  const std::string before = folder.get("me.beat");
  EXPECT_TRUE(test::comes_true([&] { return folder.get("me.beat") != before; }));
}

// However late it beats: somebody who looks has heard of it since.
TEST(Leases, OneThatBeatsKeepsThem) {
  const Folder folder;
  std::ofstream(folder / "lot-0-0.0") << "beating";
  Heartbeat heartbeat(folder.path(), "me", kLease);
  Leases leases(folder.path(), "lot-0", 0, 1, heartbeat);
  const Timer timer;
  for (int beat = 1; timer.seconds() < 3 * kLease; ++beat) {
    folder.put("beating.beat", std::to_string(beat));
    leases.look();
    ASSERT_FALSE(leases.is_free(0));
    std::this_thread::sleep_for(20ms);
  }
}

TEST(Leases, WhoeverIsSecondToTakeOverFails) {
  const Folder folder;
  std::ofstream(folder / "lot-0-0.0") << "gone";
  Heartbeat first(folder.path(), "first", kLease), second(folder.path(), "second", kLease);
  Leases one(folder.path(), "lot-0", 0, 1, first), two(folder.path(), "lot-0", 0, 1, second);
  one.look(), two.look();
  ASSERT_TRUE(one.is_free(0));
  ASSERT_TRUE(two.is_free(0));
  EXPECT_TRUE(two.claim(0));
  EXPECT_FALSE(one.claim(0));
  EXPECT_FALSE(one.is_mine(0));
}

TEST(Leases, FilesOfOtherThingsAreLetBe) {
  const Folder folder;
  for (const char* const name : {"lot-0-", "lot-0-7.0", "lot-0-x.0", "lot-0-0.1x", "lot-00-0.3", "lot-0-0.",
                                 "lot-1-0.done", "lot-0-99999999999999999999999.0", "lot-0-0.99999999999999"})
    std::ofstream(folder / name) << "x";
  Heartbeat heartbeat(folder.path(), "me", kLease);
  Leases leases(folder.path(), "lot-0", 0, 2, heartbeat);
  leases.look();
  EXPECT_TRUE(leases.is_free(0));
  EXPECT_TRUE(leases.is_free(1));
  EXPECT_TRUE(leases.claim(0));
}

}  // namespace
}  // namespace kdray::checkpoint
