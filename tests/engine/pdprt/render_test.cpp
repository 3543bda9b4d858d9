// PDPRT as a whole: whatever the division, queues, devices, tiles, bands and failures, the picture is the
// same and each of its rays is counted once; and the timeline and costs say what happened.
#include "engine/pdprt/render.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "engine/wavefront/hall_of_mirrors.h"
#include "engine/wavefront/tile_order.h"
#include "kdray/error.h"
#include "layout/features.h"
#include "support/device.h"
#include "support/errors.h"
#include "support/programs.h"

namespace kdray::pdprt {
namespace {

using test::expect_same;
using test::Hall;

constexpr Division kAllDivisions[] = {Division::bag, Division::contiguous, Division::interleaved};
const wavefront::Schedule kSmall{
    .tile_width = 8, .tile_height = 4, .batch_size = 64, .n_slices = 3, .fused_waves = 2};

std::uint64_t tiles_of(const Result& result) {
  return std::accumulate(result.queues.begin(), result.queues.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const QueueResult& q) { return sum + q.tiles; });
}

std::uint64_t rays_of(const Result& result) {
  return std::accumulate(result.queues.begin(), result.queues.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const QueueResult& q) { return sum + q.rays; });
}

class RenderTest : public test::EachDevice {
 protected:
  const Hall hall{};
  const device::Context one{GetParam(), 1, 0, test::kept_programs()};
  const Result reference = hall.render(one, wavefront::Schedule{});

  Result render(int n_queues, const wavefront::Schedule& schedule, const Task& task) const {
    return hall.render({device::Context(GetParam(), n_queues, 0, test::kept_programs())}, schedule, task);
  }

  void expect_whole(const Result& result) const {
    expect_same(result, reference);
    EXPECT_EQ(tiles_of(result), result.n_tiles);
    EXPECT_EQ(rays_of(result), reference.counters.total());
  }
};

TEST_P(RenderTest, EveryDivisionAndNumberOfQueues) {
  for (const int n_queues : {1, 2, 3, 8}) {
    for (const Division division : kAllDivisions) {
      for (const auto& [width, height] : {std::pair{8u, 4u}, {1u, 43u}, {32u, 32u}}) {
        SCOPED_TRACE(fmt::format("{} queues, division {}, tiles {}x{}", n_queues, static_cast<int>(division),
                                 width, height));
        wavefront::Schedule schedule = kSmall;
        schedule.tile_width = width;
        schedule.tile_height = height;
        Task task = hall.task();
        task.division = division;
        const Result result = render(n_queues, schedule, task);
        expect_whole(result);
        EXPECT_EQ(result.queues.size(), static_cast<std::size_t>(n_queues));
        EXPECT_EQ(result.n_bands, 1u);
      }
    }
  }
}

TEST_P(RenderTest, ALaunchForEachStageToo) {
  wavefront::Schedule schedule = kSmall;
  schedule.fused = false;
  for (const Division division : kAllDivisions) {
    Task task = hall.task();
    task.division = division;
    expect_whole(render(2, schedule, task));
  }
}

TEST_P(RenderTest, BandsBoundTheFilm) {
  for (const int n_queues : {1, 2}) {
    Task task = hall.task();
    const std::size_t whole = render(n_queues, kSmall, task).queues[0].device_bytes;
    task.max_film_bytes = 61 * 8 * 24;  // two rows of tiles
    const Result result = render(n_queues, kSmall, task);
    expect_whole(result);
    EXPECT_EQ(result.n_bands, 6u);
    EXPECT_LE(result.queues[0].device_bytes, whole - 61 * 35 * 24);
    task.max_film_bytes = 1;
    EXPECT_EQ(render(n_queues, kSmall, task).n_bands, 11u);
  }
}

TEST_P(RenderTest, SeveralDevices) {
  const std::vector<device::Context> contexts = device::open_contexts(GetParam() + "," + GetParam(), 3);
  ASSERT_EQ(contexts.size(), 2u);
  EXPECT_EQ(contexts[0].queues().size(), 2u);
  EXPECT_EQ(contexts[1].queues().size(), 1u);
  for (const Division division : kAllDivisions) {
    Task task = hall.task();
    task.division = division;
    expect_whole(hall.render(contexts, kSmall, task));
  }
}

// Shares make every queue launch three times at least, so that the fault comes about.
TEST_P(RenderTest, AQueueThatFailsIsReplaced) {
  for (const Division division : {Division::contiguous, Division::interleaved}) {
    for (const int n_queues : {2, 3}) {
      for (int queue = 0; queue < n_queues; ++queue) {
        for (const int launch : {1, 2, 3}) {
          SCOPED_TRACE(fmt::format("division {}, queue {} of {}, launch {}", static_cast<int>(division),
                                   queue, n_queues, launch));
          device::FaultInjector faults(fmt::format("{}@{}", queue, launch));
          Task task = hall.task();
          task.division = division;
          task.fault_injector = &faults;
          const Result result = render(n_queues, kSmall, task);
          expect_whole(result);
          for (int q = 0; q < n_queues; ++q)
            EXPECT_EQ(result.queues[static_cast<std::size_t>(q)].failure.empty(), q != queue);
          const QueueResult& failed = result.queues[static_cast<std::size_t>(queue)];
          EXPECT_NE(failed.failure.find("CL_OUT_OF_RESOURCES"), std::string::npos) << failed.failure;
          EXPECT_EQ(failed.tiles, 0u);
          EXPECT_GT(failed.tiles_lost, 0u);
        }
      }
    }
  }
}

// Which queue comes to its fifth launch is left to chance; the picture is not.
TEST_P(RenderTest, SoItIsWithABagAndManyFaults) {
  for (const int launch : {1, 2, 3, 5, 9}) {
    SCOPED_TRACE(launch);
    device::FaultInjector faults(fmt::format("0@{},2@{}", launch, launch + 1));
    Task task = hall.task();
    task.fault_injector = &faults;
    expect_whole(render(3, kSmall, task));
  }
}

TEST_P(RenderTest, AndInLaterBands) {
  for (const int launch : {4, 8, 20}) {
    SCOPED_TRACE(launch);
    device::FaultInjector faults(fmt::format("1@{}", launch));
    Task task = hall.task();
    task.fault_injector = &faults;
    task.division = Division::interleaved;
    task.max_film_bytes = 61 * 12 * 24;
    const Result result = render(2, kSmall, task);
    expect_whole(result);
    EXPECT_FALSE(result.queues[1].failure.empty());
  }
}

TEST_P(RenderTest, WhenAllQueuesFailSoDoesTheFrame) {
  for (const int n_queues : {1, 3}) {
    device::FaultInjector faults("0@1,1@2,2@3");
    Task task = hall.task();
    task.fault_injector = &faults;
    task.division = Division::interleaved;
    try {
      (void)render(n_queues, kSmall, task);
      FAIL() << "no exception";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::no_device);
      EXPECT_NE(std::string(error.what()).find("fault on purpose"), std::string::npos) << error.what();
    }
    expect_whole(render(n_queues, kSmall, hall.task()));  // leaves nothing behind
  }
}

TEST_P(RenderTest, OtherQueuesTakeOverWhereMemoryIsTooLittle) {
  device::FaultInjector faults("0@2:memory");
  Task task = hall.task();
  task.fault_injector = &faults;
  task.division = Division::interleaved;
  const Result result = render(2, kSmall, task);
  expect_whole(result);
  EXPECT_NE(result.queues[0].failure.find("memory does not suffice"), std::string::npos)
      << result.queues[0].failure;
  device::FaultInjector on_all("0@2:memory,1@1:memory");
  task.fault_injector = &on_all;
  EXPECT_TRUE(test::fails([&] { (void)render(2, kSmall, task); }, "memory does not suffice",
                          ErrorCode::out_of_memory));
}

TEST_P(RenderTest, ABugOrAnErrorOfKdraysOwnEndsTheFrame) {
  const auto ends = [&](const std::string& specification, const std::string& text, ErrorCode code) {
    device::FaultInjector faults(specification);
    Task task = hall.task();
    task.fault_injector = &faults;
    task.division = Division::interleaved;
    return test::fails([&] { (void)render(3, kSmall, task); }, text, code);
  };
  EXPECT_TRUE(ends("1@2:bug", "CL_INVALID_KERNEL_ARGS; this is a fault of kdray", ErrorCode::internal));
  EXPECT_TRUE(ends("1@2:input", "fault on purpose", ErrorCode::input));
  EXPECT_TRUE(ends("0@1,1@2:bug", "CL_INVALID_KERNEL_ARGS", ErrorCode::internal));
}

TEST_P(RenderTest, ProgressThatThrowsEndsTheFrame) {
  Task task = hall.task();
  task.frame.n_samples = 400;
  task.features |= KDRAY_FEATURE_SUPERSAMPLE;
  task.progress = [](double) { throw std::runtime_error("enough"); };
  EXPECT_THROW((void)render(2, kSmall, task), std::runtime_error);
}

TEST_P(RenderTest, TheTimelineTellsOfEveryLaunch) {
  for (const bool fused : {true, false}) {
    timeline::Timeline timeline;
    Task task = hall.task();
    task.timeline = &timeline;
    wavefront::Schedule schedule = kSmall;
    schedule.fused = fused;
    const double before = timeline.now();
    const Result result = render(2, schedule, task);
    const double after = timeline.now();
    double launches = 0, tiles = 0, rays = 0, waves = 0;
    for (const int row : {0, 1}) {
      double last = before, busy = 0;
      for (const timeline::Span& span : timeline.spans(row)) {
        EXPECT_GE(span.start, last - 1e-6);
        EXPECT_GE(span.end, span.start);
        last = span.end;
        busy += span.end - span.start;
        ++launches;
        for (const auto& [name, value] : span.numbers)
          (name == "tiles" ? tiles : name == "rays" ? rays : waves) += value;
      }
      EXPECT_LE(last, after);
      EXPECT_NEAR(busy, result.queues[static_cast<std::size_t>(row)].busy_seconds, 1e-6);
    }
    EXPECT_EQ(tiles, result.n_tiles);
    EXPECT_EQ(rays, static_cast<double>(result.counters.total()));
    EXPECT_EQ(waves, static_cast<double>(result.counters.waves));
    EXPECT_EQ(launches, static_cast<double>(result.counters.launches));
  }
}

// More queues than tiles: some begin a list when there are tiles left, and find that another took them. Their
// launches count.
TEST_P(RenderTest, LaunchesThatFindNothingAreToldOf) {
  constexpr int kQueues = 8;
  wavefront::Schedule schedule = kSmall;
  schedule.tile_width = schedule.tile_height = 32;
  for (int i = 0; i < 20; ++i) {
    timeline::Timeline timeline;
    Task task = hall.task();
    task.timeline = &timeline;
    const Result result = render(kQueues, schedule, task);
    std::size_t launches = 0;
    for (int row = 0; row < kQueues; ++row) launches += timeline.spans(row).size();
    ASSERT_EQ(launches, result.counters.launches);
  }
}

TEST_P(RenderTest, TilesCostWhatTheQueuesTook) {
  timeline::Timeline timeline;
  Task task = hall.task();
  task.timeline = &timeline;
  const Result result = render(1, kSmall, task);
  if (result.tile_cost.total == 0) GTEST_SKIP() << "the device has no cycle counter";
  ASSERT_EQ(result.tile_seconds.size(), result.n_tiles);
  const double sum = std::accumulate(result.tile_seconds.begin(), result.tile_seconds.end(), 0.0);
  const double units = device::Context(GetParam(), 1).info().compute_units;
  EXPECT_NEAR(sum, result.queues[0].busy_seconds * units, 1e-6 * sum);
  EXPECT_EQ(result.tile_cost.costliest,
            *std::max_element(result.tile_seconds.begin(), result.tile_seconds.end()));
  EXPECT_TRUE(hall.render(one, kSmall).tile_seconds.empty());  // not asked for
}

KDRAY_FOR_EACH_DEVICE(RenderTest);

}  // namespace
}  // namespace kdray::pdprt
