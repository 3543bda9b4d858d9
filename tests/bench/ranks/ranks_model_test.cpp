// The simulation of ranks against closed forms: queues that share cores, equal tiles without a network, what
// is counted, and that nothing is random in it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "bench/ranks/bench.h"
#include "wavefront/curve.h"

namespace kdray::bench {
namespace {

constexpr std::uint32_t kSide = 8, kAcross = 32, kDown = 16;
constexpr std::size_t kTiles = kAcross * kDown;
constexpr double kTile = 20e-3;  // seconds

// A frame of equal tiles, a launch for each of them.
ReplayedFrame equal_tiles() {
  ReplayedFrame frame;
  frame.width = kAcross * kSide, frame.height = kDown * kSide;
  frame.tile_width = frame.tile_height = kSide;
  frame.curve = wavefront::tile_curve(kAcross, 0, kDown);
  frame.tile_seconds.assign(kTiles, kTile);
  frame.wave_seconds = kTile, frame.waves_of_launch = 1, frame.guessed_waves = 1;
  frame.index();
  return frame;
}

RanksSetting without_network(int ranks) {
  RanksSetting setting;
  setting.ranks = ranks;
  setting.look = 1e-3;
  return setting;
}

TEST(SharedCoresTest, OneAfterTheOtherEndsByItsWork) {
  SharedCores cores([](std::size_t n) { return n > 1 ? 1.0 / static_cast<double>(n) : 1.0; });
  cores.start(0, 1);
  cores.start(1, 2);
  EXPECT_DOUBLE_EQ(cores.next_end(), 2);  // both at half the speed
  cores.advance(2);
  EXPECT_EQ(cores.take_ended(), 0);
  EXPECT_EQ(cores.take_ended(), std::nullopt);
  EXPECT_DOUBLE_EQ(cores.next_end(), 3);  // the other has a core for itself
  cores.advance(2.5);
  cores.start(2, 0.25);
  EXPECT_DOUBLE_EQ(cores.next_end(), 3);
  cores.advance(3);
  EXPECT_EQ(cores.take_ended(), 2);
  EXPECT_DOUBLE_EQ(cores.next_end(), 3.25);
}

TEST(SpeedOfTest, CoresTogetherChangeEvenlyBetweenWhatWasMeasured) {
  const auto speed = speed_of({{1, {1, 1e-3}}, {2, {0.9, 1e-3}}, {4, {0.5, 2e-3}}});
  EXPECT_DOUBLE_EQ(speed(0), 1);
  EXPECT_DOUBLE_EQ(speed(1), 1);
  EXPECT_DOUBLE_EQ(speed(2), 0.9);
  EXPECT_DOUBLE_EQ(speed(3), 1.9 / 3);  // 1.8 and 2.0 together
  EXPECT_DOUBLE_EQ(speed(4), 0.5);
  EXPECT_DOUBLE_EQ(speed(16), 2.0 / 16);
}

// A rank holds at most two launches' tiles beside the one in work.
TEST(SimulatePdprtTest, EqualTilesWithoutANetworkTakeWhatTheyMust) {
  const ReplayedFrame frame = equal_tiles();
  double before = 1e9;
  for (const int ranks : {1, 2, 3, 4, 7, 8, 16, 31, 64}) {
    SCOPED_TRACE(ranks);
    const SimulatedRanks simulated = simulate_pdprt(frame, without_network(ranks));
    const double least = std::ceil(static_cast<double>(kTiles) / ranks) * kTile;
    EXPECT_NEAR(simulated.busy, kTiles * kTile, 1e-9);
    EXPECT_GE(simulated.seconds, static_cast<double>(kTiles) / ranks * kTile - 1e-9);
    EXPECT_LE(simulated.seconds, least + 3 * kTile);
    EXPECT_LE(simulated.seconds, before + kTile);
    before = simulated.seconds;
  }
  EXPECT_NEAR(simulate_pdprt(frame, without_network(1)).seconds, kTiles * kTile, 1e-5);
}

// Four ranks on one core are no faster than one.
TEST(SimulatePdprtTest, SharedCoresAreNoFaster) {
  RanksSetting setting = without_network(4);
  setting.speed = [](std::size_t n) { return 1.0 / static_cast<double>(n); };
  const double seconds = simulate_pdprt(equal_tiles(), setting).seconds;
  EXPECT_NEAR(seconds, kTiles * kTile, 1e-3);
}

// Every tile of another rank's comes as a record: a head of 88 bytes and three sums of 8 bytes a pixel.
TEST(SimulatePdprtTest, BytesAreThoseOfRecords) {
  const ReplayedFrame frame = equal_tiles();
  EXPECT_EQ(simulate_pdprt(frame, without_network(1)).messages, 0u);
  constexpr double kRecord = 88 + 24.0 * kSide * kSide;
  for (const int ranks : {2, 8, 64}) {
    SCOPED_TRACE(ranks);
    const SimulatedRanks simulated = simulate_pdprt(frame, without_network(ranks));
    const double share = 1 - 1.0 / ranks, bytes = static_cast<double>(simulated.bytes);
    EXPECT_GT(bytes, 0.9 * share * kTiles * kRecord);
    EXPECT_LT(bytes, kTiles * (kRecord + 4) + 64.0 * static_cast<double>(simulated.messages));
  }
}

// A bar of ranks.md, with the queues' own schedule: a delay of 2.5 ms each way is in no tile's way.
TEST(SimulatePdprtTest, ADelayIsInNoTilesWay) {
  RanksSetting setting = without_network(4);
  setting.look = 1e-3;
  const double without = simulate_pdprt(equal_tiles(), setting).seconds;
  setting.delay = 2.5e-3;
  EXPECT_LT(simulate_pdprt(equal_tiles(), setting).seconds, without * 1.05);
}

// What a message occupies rank 0 for is what thousands of ranks wait for: it is asked by each at least twice.
TEST(SimulatePdprtTest, RankZeroIsTheBottleneckOfThousands) {
  RanksSetting setting = without_network(2000);
  setting.look = 1e-3;
  setting.messages.take = 1e-5;
  const SimulatedRanks simulated = simulate_pdprt(equal_tiles(), setting);
  EXPECT_GT(simulated.seconds, 0.9 * setting.messages.take * 1999);
}

TEST(SimulatePdprtTest, TheSameEachTime) {
  RanksSetting setting = without_network(5);
  setting.look = 1e-3;
  setting.messages = {.latency = 1e-5, .bandwidth = 1e9, .send = 1e-6, .take = 2e-6};
  const ReplayedFrame frame = equal_tiles();
  const SimulatedRanks a = simulate_pdprt(frame, setting), b = simulate_pdprt(frame, setting);
  EXPECT_EQ(a.seconds, b.seconds);
  EXPECT_EQ(a.messages, b.messages);
  EXPECT_EQ(a.bytes, b.bytes);
}

}  // namespace
}  // namespace kdray::bench
