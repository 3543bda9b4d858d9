// The simulation of ODPRT: every ray of invented lives is served once in each of its stops, whatever the
// ranks, the network and the pools; what is sent, and closed forms.
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "bench/ranks/simulate_odprt.h"

namespace kdray::bench {
namespace {

constexpr int kSide = 32, kTile = 8, kTilesAcross = kSide / kTile, kDepth = 4;
constexpr double kRay = 1e-5;  // seconds

LivedFrame small_frame() {
  LivedFrame lived;
  lived.width = lived.height = kSide, lived.depth = kDepth, lived.tile = kTile;
  lived.n_lights = 2;
  lived.reflects = lived.transmits = true;
  return lived;
}

// Eye rays and tiles; each tile is made by a rank in turn.
DividedFrame eye_rays(int ranks) {
  DividedFrame frame;
  frame.n_tiles = kTilesAcross * kTilesAcross;
  frame.tiles.of_queues.resize(static_cast<std::size_t>(ranks));
  for (std::uint32_t tile = 0; tile < frame.n_tiles; ++tile)
    frame.tiles.of_queues[tile % static_cast<std::uint32_t>(ranks)].push_back(tile);
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const std::uint32_t tile = i / kSide / kTile * kTilesAcross + i % kSide / kTile;
    frame.tile_of_first.push_back(tile);
    frame.traffic.first.push_back(i);
    frame.traffic.journeys.push_back({{{tile % static_cast<std::uint32_t>(ranks), kRay}}, {}, 1});
    frame.is_shadow.push_back(0);
  }
  frame.pixels_of.assign(static_cast<std::size_t>(ranks), kSide * kSide / static_cast<std::size_t>(ranks));
  return frame;
}

// Lives of any shape: stops with any ranks, up to two shadow rays and two others for each that ends.
DividedFrame random_lives(int ranks, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto any_rank = [&] { return static_cast<std::uint32_t>(random() % static_cast<unsigned>(ranks)); };
  DividedFrame frame = eye_rays(ranks);
  std::vector<Journey>& journeys = frame.traffic.journeys;
  for (std::uint32_t i = 0; i < journeys.size(); ++i) {
    for (std::uint64_t more = random() % 3; more > 0; --more)
      if (const std::uint32_t next = any_rank(); next != journeys[i].hops.back().queue)
        journeys[i].hops.push_back({next, kRay * static_cast<double>(random() % 5)});
    if (frame.is_shadow[i]) continue;
    const auto lead_to = [&](bool shadow) {
      journeys[i].next.push_back(static_cast<std::uint32_t>(journeys.size()));
      const std::uint32_t depth = journeys[i].depth + (shadow ? 0 : 1);
      const std::uint32_t start = random() % 4 == 0 ? any_rank() : journeys[i].hops.back().queue;
      journeys.push_back({{{start, kRay}}, {}, depth});
      frame.is_shadow.push_back(shadow);
    };
    for (std::uint64_t n = random() % 3; n > 0; --n) lead_to(true);
    if (journeys[i].depth < kDepth)
      for (std::uint64_t n = random() % 3; n > 0; --n) lead_to(false);
  }
  return frame;
}

double work_of(const Traffic& traffic) {
  double sum = 0;
  for (const Journey& journey : traffic.journeys)
    for (const Hop& hop : journey.hops) sum += hop.seconds;
  return sum;
}

RanksSetting setting_of(int ranks) {
  RanksSetting setting;
  setting.ranks = ranks;
  setting.messages = {.latency = 2e-6, .bandwidth = 1e9, .send = 1e-7, .take = 1e-6};
  return setting;
}

TEST(SimulateOdprtTest, OneRankTakesWhatItsRaysCost) {
  const SimulatedOdprt simulated =
      simulate_odprt(small_frame(), eye_rays(1), {.end_seconds = 0.25}, setting_of(1));
  EXPECT_NEAR(simulated.busy, kSide * kSide * kRay, 1e-9);
  EXPECT_NEAR(simulated.seconds, 0.25 + kSide * kSide * kRay, 4e-3);  // the end is found by looks
  EXPECT_EQ(simulated.rays_sent, 0u);
  EXPECT_EQ(simulated.messages, 0u);
}

TEST(SimulateOdprtTest, RaysThatStayAreSharedOut) {
  const double alone = simulate_odprt(small_frame(), eye_rays(1), {}, setting_of(1)).seconds;
  const SimulatedOdprt four = simulate_odprt(small_frame(), eye_rays(4), {}, setting_of(4));
  EXPECT_NEAR(four.busy, kSide * kSide * kRay, 1e-9);
  EXPECT_GE(four.seconds, alone / 4 - 4e-3);
  EXPECT_LE(four.seconds, alone / 4 + 8e-3);
}

TEST(SimulateOdprtTest, EveryRayIsServedOnceAtEachStop) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::mt19937_64 random(seed);
    const int ranks = static_cast<int>(random() % 9) + 1;
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << ranks << " ranks");
    const DividedFrame frame = random_lives(ranks, seed);
    RanksSetting setting = setting_of(ranks);
    setting.delay = 1e-3 * static_cast<double>(random() % 4);
    setting.seed = seed;
    const SimulatedOdprt simulated = simulate_odprt(small_frame(), frame, {}, setting);
    EXPECT_NEAR(simulated.busy, work_of(frame.traffic), 1e-6);
    std::uint64_t least = 0;  // rays of tiles that others took are sent once more
    for (const Journey& journey : frame.traffic.journeys) {
      least += journey.hops.size() - 1;
      for (const std::uint32_t next : journey.next)
        least += frame.traffic.journeys[next].hops.front().queue != journey.hops.back().queue ? 1 : 0;
    }
    EXPECT_GE(simulated.rays_sent, least);
    EXPECT_LE(simulated.rays_sent, least + kSide * kSide);
    EXPECT_GE(simulated.seconds, simulated.busy / ranks - 1e-9);
  }
}

TEST(SimulateOdprtTest, TheSameEachTime) {
  const DividedFrame frame = random_lives(5, 3);
  const auto once = [&] { return simulate_odprt(small_frame(), frame, {}, setting_of(5)); };
  const SimulatedOdprt a = once(), b = once();
  EXPECT_EQ(a.seconds, b.seconds);
  EXPECT_EQ(a.messages, b.messages);
  EXPECT_EQ(a.bytes, b.bytes);
}

TEST(LeaveOutTest, AsManyAsTheFrameHasFewer) {
  std::vector<LifeRay> lives;
  for (std::uint32_t i = 0; i < 10; ++i) {
    LifeRay eye;
    eye.hit = true;
    lives.push_back(eye);
  }
  for (std::uint32_t i = 0; i < 10; ++i)
    for (int k = 0; k < 4; ++k) {
      LifeRay shadow;
      shadow.kind = LifeKind::shadow, shadow.parent = i, shadow.hit = k == 0;
      lives.push_back(shadow);
    }
  const auto kept = leave_out(lives, {10, 25, 0, 0});
  ASSERT_EQ(kept.size(), 10u + 25u);
  int n_hit = 0;
  for (const LifeRay& life : kept) {
    if (life.kind != LifeKind::shadow) continue;
    n_hit += life.hit;
    EXPECT_LT(life.parent, 10u);
  }
  EXPECT_EQ(n_hit, 10);
  EXPECT_EQ(leave_out(lives, {}).size(), lives.size());
}

TEST(TraceWhereMadeTest, BeforeOthersAreAsked) {
  const auto stops = [](std::vector<Hop> hops, bool is_shadow) {
    Journey journey{std::move(hops), {}, 1};
    trace_where_made(journey, is_shadow);
    std::vector<std::pair<std::uint32_t, double>> stops;
    for (const Hop& hop : journey.hops) stops.emplace_back(hop.queue, hop.seconds);
    return stops;
  };
  using Stops = std::vector<std::pair<std::uint32_t, double>>;
  EXPECT_EQ(stops({{0, 1}, {1, 2}, {0, 4}, {2, 8}}, false), (Stops{{0, 5}, {1, 2}, {2, 8}}));
  EXPECT_EQ(stops({{0, 1}, {1, 2}, {0, 4}}, true), (Stops{{0, 5}}));
  EXPECT_EQ(stops({{0, 1}, {1, 2}, {0, 4}}, false), (Stops{{0, 1}, {1, 2}, {0, 4}}));
  EXPECT_EQ(stops({{0, 1}, {1, 2}}, true), (Stops{{0, 1}, {1, 2}}));
}

}  // namespace
}  // namespace kdray::bench
