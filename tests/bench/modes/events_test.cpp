// What    Simulated ODPRT, where the answer is known: pipelines, shares, latencies, full ports, chains of
//         rays.
#include "bench/modes/events.h"

#include <gtest/gtest.h>

namespace kdray::bench {
namespace {

const Network kFree{};  // no latency, no end of bandwidth

// n eye journeys of the same hops.
Traffic same(std::size_t n, const std::vector<Hop>& hops, double rays = 1) {
  Traffic traffic;
  traffic.rays_per_journey = rays;
  for (std::uint32_t i = 0; i < n; ++i) {
    traffic.journeys.push_back({hops, {}, 1});
    traffic.first.push_back(i);
  }
  return traffic;
}

TEST(SimulatedRays, WithoutANetworkTheBusiestQueueIsAllThatCounts) {
  Traffic traffic;
  for (std::uint32_t i = 0; i < 12; ++i) {
    traffic.journeys.push_back({{{i % 3 == 0 ? 0u : 1u, 0.5}}, {}, 1});  // 4 and 8 of them
    traffic.first.push_back(i);
  }
  const Simulated outcome = simulate(traffic, 4, kFree);
  EXPECT_DOUBLE_EQ(outcome.seconds, 4);
  EXPECT_DOUBLE_EQ(outcome.busiest, 4);
  EXPECT_DOUBLE_EQ(outcome.rays_sent, 0);
}

TEST(SimulatedRays, OneJourneyPaysForEveryHop) {
  const Network network{64 * 10 / 2.0, 0.25, 64};  // ten rays take 2 seconds
  const Simulated outcome = simulate(same(1, {{0, 1}, {1, 3}, {0, 1}}, 10), 2, network);
  EXPECT_DOUBLE_EQ(outcome.seconds, 5 + 2 * (2 + 0.25));
  EXPECT_DOUBLE_EQ(outcome.rays_sent, 20);
  EXPECT_DOUBLE_EQ(outcome.busiest_port, 2);
  EXPECT_DOUBLE_EQ(outcome.critical_path, 0.5 + 2 * (0.2 + 0.25));  // of a single ray
}

TEST(SimulatedRays, APipelineFillsAndDrains) {
  for (const std::size_t n : {1u, 5u, 100u})
    EXPECT_DOUBLE_EQ(simulate(same(n, {{0, 1}, {1, 1}}), 2, kFree).seconds, static_cast<double>(n) + 1);
}

TEST(SimulatedRays, LatencyIsHiddenByOtherRays) {
  const Network far{std::numeric_limits<double>::infinity(), 1000, 64};
  EXPECT_DOUBLE_EQ(simulate(same(100, {{0, 1}, {1, 1}}), 2, far).seconds, 101 + 1000);
}

TEST(SimulatedRays, AFullPortHoldsThemUp) {
  const Network narrow{64, 0, 64};  // a ray a second
  const Simulated outcome = simulate(same(100, {{0, 0.25}, {1, 0.25}}), 2, narrow);
  EXPECT_DOUBLE_EQ(outcome.seconds, 0.25 + 100 + 0.25);
  EXPECT_DOUBLE_EQ(outcome.busiest_port, 100);
}

TEST(SimulatedRays, PortsOfAReceiverTakeTurnsToo) {
  const Network narrow{64, 0, 64};
  Traffic traffic = same(1, {{0, 1}, {2, 1}});
  traffic.journeys.push_back({{{1, 1}, {2, 1}}, {}, 1});
  traffic.first.push_back(1);
  // Both arrive at once: the second has to wait for a second at the port, where the first has been served
  // meanwhile.
  EXPECT_DOUBLE_EQ(simulate(traffic, 3, narrow).seconds, 1 + 2 + 1);
}

TEST(SimulatedRays, AChainOfRaysIsTheLeastThatItTakes) {
  const Network far{std::numeric_limits<double>::infinity(), 2, 64};
  Traffic traffic;
  for (std::uint32_t i = 0; i < 4; ++i) traffic.journeys.push_back({{{i, 1}}, {}, i + 1});
  for (std::uint32_t i = 0; i < 3; ++i) traffic.journeys[i].next = {i + 1};
  traffic.first = {0};
  const Simulated outcome = simulate(traffic, 4, far);
  EXPECT_DOUBLE_EQ(outcome.seconds, 4 + 3 * 2);
  EXPECT_DOUBLE_EQ(outcome.critical_path, outcome.seconds);
}

TEST(SimulatedRays, DeepOnesGoFirst) {
  // Queue 0 has two eye rays; the first one's child has to go on to queue 1, which it does before the second
  // is begun.
  Traffic traffic;
  traffic.journeys = {{{{0, 1}}, {2}, 1}, {{{0, 1}}, {}, 1}, {{{0, 1}, {1, 5}}, {}, 2}};
  traffic.first = {0, 1};
  EXPECT_DOUBLE_EQ(simulate(traffic, 2, kFree).seconds, 2 + 5);
}

TEST(SimulatedRays, EveryRayThatIsSentCounts) {
  Traffic traffic = same(3, {{0, 1}, {1, 1}, {0, 1}}, 4);
  traffic.journeys.push_back({{{1, 1}}, {}, 2});
  traffic.journeys[0].next = {3};
  EXPECT_DOUBLE_EQ(simulate(traffic, 2, kFree).rays_sent, 28);
}

}  // namespace
}  // namespace kdray::bench
