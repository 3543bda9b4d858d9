// PDPRT over ranks that are threads: whatever their number, queues, bands and samples, rank 0 has the picture
// of one process, each ray is counted once, and a rank that fails ends all.
#include <gtest/gtest.h>

#include <numeric>

#include "base/hash.h"
#include "cluster/transport/simulated.h"
#include "engine/pdprt/render.h"
#include "engine/wavefront/hall_of_mirrors.h"
#include "kdray/error.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/programs.h"
#include "support/rank_threads.h"

namespace kdray::pdprt {
namespace {

using test::expect_same;
using test::Hall;

const wavefront::Schedule kOfRanks{
    .tile_width = 8, .tile_height = 4, .batch_size = 64, .n_slices = 3, .fused_waves = 2};

class RanksTest : public test::EachDevice {
 protected:
  const Hall hall{};

  // `queues_of`: of each rank. What rank 0 has; what the ranks throw is thrown, rank 0's first.
  Result render(const std::vector<int>& queues_of, const Task& wanted,
                const std::vector<device::FaultInjector*>& faults = {}) const {
    std::vector<Result> results(queues_of.size());
    test::run_ranks(transport::in_process(static_cast<int>(queues_of.size())),
                    [&](transport::Ranks& ranks, const std::function<void()>& ready) {
                      const auto rank = static_cast<std::size_t>(ranks.rank());
                      Task task = wanted;
                      task.ranks = &ranks;
                      task.shared_frame = hash_of(std::string("a frame"));
                      if (rank < faults.size()) task.fault_injector = faults[rank];
                      const device::Context context(GetParam(), queues_of[rank], 0, test::kept_programs());
                      ready();
                      results[rank] = hall.render({context}, kOfRanks, task);
                    });
    return std::move(results.front());
  }

  // Long enough that every rank gets some of it.
  Task long_task() const {
    RenderOptions options = Hall::options();
    options.width = 300, options.height = 200;
    return hall.task(options);
  }

  Result alone(const Task& task) const {
    return hall.render({device::Context(GetParam(), 1, 0, test::kept_programs())}, kOfRanks, task);
  }
};

TEST_P(RanksTest, AnyNumberOfRanksAndQueues) {
  const Result reference = alone(hall.task());
  for (const std::vector<int>& queues :
       {std::vector{1}, {1, 1}, {2, 1, 1}, {1, 2, 1, 2}, {1, 1, 1, 1, 1, 1, 1}}) {
    SCOPED_TRACE(testing::PrintToString(queues));
    const Result result = render(queues, hall.task());
    expect_same(result, reference);
    const auto n_queues = static_cast<std::size_t>(std::accumulate(queues.begin(), queues.end(), 0));
    ASSERT_EQ(result.queues.size(), n_queues);
    std::uint64_t tiles = 0, rays = 0;
    for (const QueueResult& queue : result.queues) tiles += queue.tiles, rays += queue.rays;
    EXPECT_EQ(tiles, result.n_tiles);
    EXPECT_EQ(rays, reference.counters.total());
    EXPECT_EQ(result.queues.back().rank, static_cast<int>(queues.size()) - 1);
    for (std::size_t q = 0; q < n_queues; ++q) {
      EXPECT_EQ(result.queues[q].number, q);
      EXPECT_EQ(result.queues[q].device, reference.queues[0].device);
      EXPECT_GT(result.queues[q].device_bytes, 0u);
    }
  }
}

// Seven ranks with one bag to three of them at most: three groups.
TEST_P(RanksTest, BagsOfBags) {
  Task task = long_task();
  const Result reference = alone(task);
  task.ranks_to_a_bag = 3;
  const Result result = render({1, 1, 1, 2, 1, 1, 1}, task);
  expect_same(result, reference);
  ASSERT_EQ(result.queues.size(), 8u);
  std::uint64_t tiles = 0;
  for (const QueueResult& queue : result.queues) tiles += queue.tiles;
  EXPECT_EQ(tiles, result.n_tiles);
  Task adaptive = hall.task();
  adaptive.adaptive_target = 0.02;
  adaptive.features |= flatten::features_of_samples(1, true);
  const Result samples = alone(adaptive);
  adaptive.ranks_to_a_bag = 2;
  EXPECT_EQ(render({1, 1, 1, 1, 1}, adaptive).rgb, samples.rgb);
}

TEST_P(RanksTest, BandsAndAdaptiveSampling) {
  Task task = hall.task();
  task.max_film_bytes = std::size_t{61} * 12 * 24;  // three rows of tiles
  expect_same(render({1, 1, 2}, task), alone(hall.task()));
  Task adaptive = hall.task();
  adaptive.adaptive_target = 0.02;
  adaptive.features |= flatten::features_of_samples(1, true);
  const Result reference = alone(adaptive);
  const Result result = render({1, 2, 1}, adaptive);
  EXPECT_EQ(result.rgb, reference.rgb);
  EXPECT_EQ(result.counters.primary, reference.counters.primary);
  EXPECT_GT(reference.counters.primary, std::uint64_t{61} * 43);
}

// A queue that comes when all is done fails at nothing: then it is tried again.
constexpr int kTries = 50;

TEST_P(RanksTest, AQueueThatFailsCostsNothing) {
  Result result;
  for (int i = 0; i < kTries && (i == 0 || result.queues[2].failure.empty()); ++i) {
    device::FaultInjector second("1@2");
    result = render({1, 2, 1}, long_task(), {nullptr, &second});
  }
  EXPECT_EQ(result.rgb, alone(long_task()).rgb);
  EXPECT_NE(result.queues[2].failure, "");
}

TEST_P(RanksTest, ARankThatFailsEndsAll) {
  EXPECT_TRUE(test::fails(
      [&] {
        for (int i = 0; i < kTries; ++i) {
          device::FaultInjector second("0@1");
          const Result result = render({1, 1, 1}, long_task(), {nullptr, &second});
          if (result.queues[1].tiles > 0) return;
        }
      },
      "rank 1: ", ErrorCode::no_device));
  device::FaultInjector first("0@1");
  EXPECT_THROW(render({1, 1, 1}, long_task(), {&first}), Error);
}

KDRAY_FOR_EACH_DEVICE(RanksTest);

}  // namespace
}  // namespace kdray::pdprt
