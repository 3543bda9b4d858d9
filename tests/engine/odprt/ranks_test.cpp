// ODPRT over ranks that are threads, and over networks that are slow and deliver in any order: whatever the
// number of ranks and queues, rank 0 has the picture of one process, each ray is counted once, nothing hangs
// with buffers of a single ray, and a rank that fails ends all.
#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>
#include <random>

#include "cluster/transport/simulated.h"
#include "engine/odprt/render.h"
#include "engine/wavefront/hall_of_mirrors.h"
#include "kdray/error.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/programs.h"
#include "support/rank_threads.h"

namespace kdray::odprt {
namespace {

using test::Hall;

const wavefront::Schedule kTiles{
    .tile_width = 8, .tile_height = 4, .batch_size = 64, .n_slices = 3, .fused_waves = 2};

struct FrameSettings {
  std::vector<int> queues_of = {1};  // of each rank
  std::uint32_t n_slices = 4, ray_buffer = 0;
  double adaptive_target = 0;
  Balance balance = Balance::pilot;
  transport::Link link = {.latency = 0, .jitter = 0};
  std::uint64_t seed = 1;
  std::vector<device::FaultInjector*> fault_injector = {};
  bool small = false;  // a frame of few rays
};

class OdprtRanksTest : public test::EachDevice {
 protected:
  const Hall hall{};

  Request request_of(const device::Context& context, wavefront::Programs& programs,
                     const FrameSettings& settings) const {
    Request request;
    RenderOptions options = Hall::options();
    if (settings.small) options.width = 16, options.height = 12, options.depth = 3;
    const pdprt::Task task = hall.task(options);
    request.frame = task.frame;
    request.features = task.features;
    kTiles.apply(request.frame, request.features);
    for (const cl::CommandQueue& queue : context.queues())
      request.queues.push_back({&context, queue, &programs, request.queues.size()});
    request.table = alone(request.queues.size());
    request.balance = settings.balance;
    request.n_slices = settings.n_slices;
    request.ray_buffer = settings.ray_buffer;
    request.adaptive_target = settings.adaptive_target;
    if (settings.adaptive_target > 0) request.features |= flatten::features_of_samples(1, true);
    return request;
  }

  Result render_one(transport::Ranks* ranks, const FrameSettings& settings,
                    const std::function<void()>& ready) const {
    const auto rank = static_cast<std::size_t>(ranks ? ranks->rank() : 0);
    const device::Context context(GetParam(), settings.queues_of[rank], 0, test::kept_programs());
    wavefront::Programs programs(context, hall.tree.max_depth, hall.wide);
    Request request = request_of(context, programs, settings);
    if (rank < settings.fault_injector.size()) request.fault_injector = settings.fault_injector[rank];
    DividedScene scene(hall.flat, hall.wide);
    ready();
    if (ranks) request.table = join(*ranks, request.queues.size(), request.n_slices).table;
    return scene.render(request);
  }

  Result alone_with(FrameSettings settings) const {
    settings.queues_of = {1};
    return render_one(nullptr, settings, [] {});
  }

  // What rank 0 has.
  Result render(const FrameSettings& settings) const {
    auto transports = transport::in_process(static_cast<int>(settings.queues_of.size()));
    if (settings.link.latency > 0)
      for (auto& transport : transports)
        transport = transport::delayed(std::move(transport), settings.link,
                                       settings.seed + static_cast<std::uint64_t>(transport->rank()));
    std::vector<Result> results(settings.queues_of.size());
    test::run_ranks(std::move(transports), [&](transport::Ranks& ranks, const std::function<void()>& ready) {
      results[static_cast<std::size_t>(ranks.rank())] = render_one(&ranks, settings, ready);
    });
    return std::move(results.front());
  }

  static void expect_same(const Result& result, const Result& reference) {
    EXPECT_EQ(result.rgb, reference.rgb);
    EXPECT_EQ(result.counters.total(), reference.counters.total());
    EXPECT_EQ(result.counters.primary, reference.counters.primary);
    EXPECT_EQ(result.counters.pool_overflow, 0u);
  }
};

TEST_P(OdprtRanksTest, AnyNumberOfRanksAndQueues) {
  const Result reference = alone_with({});
  const pdprt::Result pixels_divided =
      hall.render(device::Context(GetParam(), 1, 0, test::kept_programs()), kTiles);
  EXPECT_EQ(reference.rgb, pixels_divided.rgb);
  for (const std::vector<int>& queues :
       {std::vector{1}, {1, 1}, {2, 1, 1}, {1, 2, 1, 2}, {1, 1, 1, 1, 1, 1, 1}}) {
    SCOPED_TRACE(testing::PrintToString(queues));
    const Result result = render({.queues_of = queues});
    expect_same(result, reference);
    const auto n_queues = static_cast<std::size_t>(std::accumulate(queues.begin(), queues.end(), 0));
    ASSERT_EQ(result.queues.size(), n_queues);
    EXPECT_EQ(result.queues.back().rank, static_cast<int>(queues.size()) - 1);
    for (std::size_t q = 0; q < n_queues; ++q) {
      EXPECT_EQ(result.queues[q].number, q);
      EXPECT_EQ(result.queues[q].device, reference.queues[0].device);
      EXPECT_GT(result.queues[q].device_bytes, 0u);
    }
    std::uint64_t traced = 0, travelled = 0;
    for (const QueueReport& queue : result.queues) traced += queue.rays;
    for (const auto& row : result.exchange.rays) travelled += std::accumulate(row.begin(), row.end(), 0ull);
    // A ray that looks for its hit in several parts is traced in each.
    EXPECT_GE(traced, result.counters.total());
    EXPECT_EQ(travelled > 0, n_queues > 1);
  }
}

// More than a ray could have a bit for each.
TEST_P(OdprtRanksTest, ManyQueues) {
  const Result reference = alone_with({.small = true});
  for (const std::vector<int>& queues : {std::vector{70}, {40, 33}}) {
    SCOPED_TRACE(testing::PrintToString(queues));
    expect_same(render({.queues_of = queues, .small = true}), reference);
  }
}

TEST_P(OdprtRanksTest, AdaptiveSampling) {
  const Result reference = alone_with({.adaptive_target = 0.02});
  expect_same(render({.queues_of = {1, 2, 1}, .adaptive_target = 0.02}), reference);
  EXPECT_GT(reference.counters.primary, std::uint64_t{61} * 43);
}

// Messages overtake each other, buffers hold few rays, and the ranks' queues are many for two processors.
TEST_P(OdprtRanksTest, AnyNetwork) {
  const char* const wanted = std::getenv("KDRAY_NETWORKS");
  const int n = wanted ? std::atoi(wanted) : 12;
  const Result reference = alone_with({.small = true});
  for (int seed = 1; seed <= n; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    const auto up_to = [&](std::uint32_t most) { return static_cast<std::uint32_t>(random() % (most + 1)); };
    FrameSettings settings{.small = true};
    for (std::uint32_t ranks = up_to(6) + 1; ranks > 0; --ranks)
      settings.queues_of.push_back(static_cast<int>(up_to(1)) + 1);
    constexpr std::uint32_t kBuffers[] = {0, 0, 1, 2, 5, 33};
    settings.ray_buffer = kBuffers[up_to(5)];
    settings.n_slices = up_to(7) + 1;
    settings.balance = up_to(1) == 0 ? Balance::sah : Balance::pilot;
    // With few rays to a message each costs its time on the way.
    const bool few = settings.ray_buffer > 0 && settings.ray_buffer < 33;
    constexpr double kLatencies[] = {1e-6, 2e-5, 1e-3};
    settings.link = {
        .latency = kLatencies[up_to(few ? 0 : 2)], .jitter = 10, .bandwidth = up_to(1) == 0 ? 1e9 : 2e7};
    settings.seed = static_cast<std::uint64_t>(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", queues "
                                    << testing::PrintToString(settings.queues_of) << ", buffers of "
                                    << settings.ray_buffer << ", latency " << settings.link.latency);
    expect_same(render(settings), reference);
    if (HasFailure()) return;
  }
}

TEST_P(OdprtRanksTest, ARankThatFailsEndsAll) {
  device::FaultInjector second("0@1");
  EXPECT_TRUE(test::fails(
      [&] {
        render({.queues_of = {1, 1, 1}, .fault_injector = {nullptr, &second}});
      },
      "rank 1: ", ErrorCode::no_device));
  device::FaultInjector first("0@1");
  EXPECT_THROW(render({.queues_of = {1, 1, 1}, .fault_injector = {&first}}), Error);
}

KDRAY_FOR_EACH_DEVICE(OdprtRanksTest);

}  // namespace
}  // namespace kdray::odprt
