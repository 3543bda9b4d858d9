// A schedule changes time and memory, never the picture: odd batch, tile, slice and light-batch sizes, one
// slice, batches of one ray, full pools, a launch per stage or for all of them; with more lights than a round
// serves, every kind of primitive, several samples, and pictures of one pixel. And the pool's bound is tight
// enough to be a bound and loose enough to hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/wavefront/hall_of_mirrors.h"
#include "kdray/error.h"
#include "layout/rays.layout.h"
#include "support/device.h"

namespace kdray::wavefront {
namespace {

using test::expect_same;
using test::Hall;

class ScheduleTest : public test::EachDevice {};

TEST_P(ScheduleTest, NoScheduleChangesThePicture) {
  const Hall prepared;
  const device::Context context(GetParam(), 1);
  const pdprt::Result reference = prepared.render(context, Schedule{});
  EXPECT_GT(reference.counters.refracted, 5000u);
  EXPECT_EQ(reference.counters.primary, 61u * 43);
  // Batches of next to nothing take a launch for every few rays.
  RenderOptions few = Hall::options();
  few.width = 19, few.height = 13;
  const pdprt::Result reference_of_few = prepared.render(context, Schedule{}, few);
  EXPECT_GT(reference_of_few.counters.refracted, 500u);
  const Schedule schedules[] = {
      {.tile_width = 1, .tile_height = 1, .batch_size = 1, .n_slices = 7, .light_batch = 1},
      {.tile_width = 8, .tile_height = 8, .batch_size = 3, .n_slices = 1, .light_batch = 2},
      {.tile_width = 64, .tile_height = 64, .batch_size = 1000, .n_slices = 5, .light_batch = 5},
      {.tile_width = 5, .tile_height = 17, .batch_size = 31, .n_slices = 33, .light_batch = 3},
      {.tile_width = 100, .tile_height = 1, .batch_size = 16, .n_slices = 3, .light_batch = 100},
  };
  for (Schedule schedule : schedules) {
    SCOPED_TRACE(schedule.batch_size);
    const auto expect_the_same = [&] {
      if (schedule.batch_size < 16)
        expect_same(prepared.render(context, schedule, few), reference_of_few);
      else
        expect_same(prepared.render(context, schedule), reference);
    };
    for (const std::uint32_t waves : {1u, 3u, 64u}) {
      schedule.fused_waves = waves;
      expect_the_same();
    }
    schedule.fused = false;
    for (const std::size_t work_group : {1u, 7u, 64u}) {
      schedule.work_group = work_group;
      schedule.film_piece = 1000 * work_group;
      expect_the_same();
    }
  }
}

TEST_P(ScheduleTest, NorInDouble) {
  if (!test::computes_in_double(GetParam()))
    GTEST_SKIP() << "device " << GetParam() << " does not compute in double";
  const Hall prepared;
  const device::Context context(GetParam(), 1);
  const Schedule in_double{.traversal = Traversal::binary, .precision = Precision::float64};
  const pdprt::Result reference = prepared.render(context, in_double);
  EXPECT_GT(reference.counters.refracted, 5000u);
  for (const bool fused : {true, false}) {
    Schedule schedule = in_double;
    schedule.fused = fused;
    schedule.batch_size = fused ? 3 : 31;
    schedule.n_slices = 5;
    schedule.light_batch = 2;
    expect_same(prepared.render(context, schedule), reference);
  }
}

TEST_P(ScheduleTest, NorDoesItWithSeveralSamplesAPixel) {
  const Hall prepared;
  const device::Context context(GetParam(), 1);
  for (const int samples : {2, 5, 16, 37}) {
    SCOPED_TRACE(samples);
    RenderOptions options = Hall::options();
    options.width = 13;
    options.height = 9;
    options.depth = 3;
    options.samples = samples;
    const pdprt::Result reference = prepared.render(context, Schedule{}, options);
    EXPECT_EQ(reference.counters.primary, 13u * 9 * static_cast<unsigned>(samples));
    expect_same(prepared.render(context, {.tile_width = 4, .tile_height = 3, .batch_size = 7}, options),
                reference);
    expect_same(
        prepared.render(context, {.tile_width = 13, .tile_height = 1, .batch_size = 100, .fused = false},
                        options),
        reference);
  }
}

TEST_P(ScheduleTest, TheSmallestPictures) {
  const Hall prepared;
  const device::Context context(GetParam(), 1);
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 2}, {3, 1}, {17, 1}}) {
    SCOPED_TRACE(width);
    RenderOptions options = Hall::options();
    options.width = width;
    options.height = height;
    const pdprt::Result reference = prepared.render(context, Schedule{}, options);
    EXPECT_EQ(reference.counters.primary, static_cast<unsigned>(width * height));
    EXPECT_GT(reference.rgb[0], 0.0f);
    expect_same(prepared.render(context, {.tile_width = 2, .tile_height = 2, .batch_size = 1, .fused = false},
                                options),
                reference);
  }
}

TEST_P(ScheduleTest, DepthOneNeedsNoPool) {
  const Hall prepared;
  const device::Context context(GetParam(), 1);
  RenderOptions options = Hall::options();
  options.depth = 1;
  const pdprt::Result flat = prepared.render(context, Schedule{}, options);
  EXPECT_EQ(flat.counters.reflected + flat.counters.refracted, 0u);
  EXPECT_GT(flat.counters.skipped_depth, 0u);
  expect_same(prepared.render(context, {.batch_size = 50, .fused = false}, options), flat);
}

// The stages' seconds are what the launches took, and each stage took some of it.
TEST_P(ScheduleTest, EveryStageIsTimed) {
  const Hall prepared;
  const device::Context context(GetParam(), 1);
  for (const bool fused : {true, false}) {
    const pdprt::Result result = prepared.render(context, {.fused = fused});
    if (fused && result.stage_seconds.count("shade") == 0) continue;  // no cycle counter
    double sum = 0;
    for (const char* stage : {"admit", "trace_closest", "shade", "trace_shadow", "add"}) {
      ASSERT_EQ(result.stage_seconds.count(stage), 1u) << stage;
      EXPECT_GT(result.stage_seconds.at(stage), 0) << stage;
      sum += result.stage_seconds.at(stage);
    }
    EXPECT_LT(sum, result.render_seconds);
  }
}

TEST_P(ScheduleTest, SeveralQueuesGiveTheSamePicture) {
  const Hall prepared;
  const pdprt::Result one = prepared.render(device::Context(GetParam(), 1), Schedule{});
  const Schedule small{.tile_width = 8, .tile_height = 2};
  for (const int queues : {2, 3}) {
    const pdprt::Result many = prepared.render(device::Context(GetParam(), queues), small);
    EXPECT_EQ(many.rgb, one.rgb) << queues;
    EXPECT_EQ(many.counters.total(), one.counters.total());
    EXPECT_EQ(many.queues.size(), static_cast<std::size_t>(queues));
  }
}

TEST_P(ScheduleTest, TheWeightCutSavesRaysAndStaysBelowItsPromise) {
  const Hall prepared;
  const device::Context context(GetParam(), 1);
  const pdprt::Result full = prepared.render(context, Schedule{});
  constexpr double kStep = 0.25;
  RenderOptions options = Hall::options();
  options.min_weight = kStep;
  const pdprt::Result cut = prepared.render(context, Schedule{}, options);
  EXPECT_LT(cut.counters.total(), full.counters.total());
  EXPECT_GT(cut.counters.skipped_weight, 0u);
  // Each ray that is left out brings less than the cut; a pixel may lose several.
  double mean = 0;
  for (std::size_t i = 0; i < full.rgb.size(); ++i)
    mean += 3 * std::abs(full.rgb[i] - cut.rgb[i]) / static_cast<double>(full.rgb.size());
  EXPECT_LT(mean, kStep);
}

// The frame's pool taken down to less than the bound must be noticed, not written past.
TEST_P(ScheduleTest, APoolThatIsTooSmallIsAnErrorNotAWrongPicture) {
  const Hall prepared;
  const device::Context context(GetParam(), 1);
  const SceneBuffers buffers(context, prepared.flat, prepared.wide);
  Programs programs(context, prepared.tree.max_depth, prepared.wide);
  RenderOptions options;
  options.width = options.height = 32;
  layout::Frame frame =
      flatten::make_frame(prepared.scene, prepared.geometry, flatten::resolved(options, {}));
  for (const bool fused : {true, false}) {
    const Schedule schedule{.n_slices = 1, .fused = fused};
    schedule.apply(frame, prepared.features);
    frame.pool_size = 10;
    Wavefront wavefront(context, context.queues().front(), buffers, programs, frame, schedule,
                        prepared.features, {.tiles = 1, .pixels = 32 * 32});
    wavefront.begin(0);
    const layout::u32 tile[] = {KDRAY_TILE(0u, 0u)};
    bool first = true;
    const auto feed = [&](const Progress&) {
      return std::optional(std::exchange(first, false) ? std::span<const layout::u32>(tile)
                                                       : std::span<const layout::u32>());
    };
    try {
      wavefront.render(feed);
      FAIL() << "no exception";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::internal) << error.what();
    }
  }
}

// However little a device gives in one piece, a schedule that was made to fit has no larger buffer, and keeps
// what it can.
TEST(Schedule, FitsIntoWhatADeviceGivesInOnePiece) {
  const Hall hall{};
  const RenderOptions options = flatten::resolved(Hall::options(), {});
  const layout::Frame scene_frame = flatten::make_frame(hall.scene, hall.geometry, options);
  const Schedule wanted{.n_slices = 2112};
  for (const std::size_t limit : {std::size_t{64} << 10, std::size_t{1} << 20, std::size_t{128} << 20}) {
    SCOPED_TRACE(limit);
    Schedule schedule = wanted;
    schedule.fit(scene_frame, hall.features, limit);
    layout::Frame frame = scene_frame;
    schedule.apply(frame, hall.features);
    const std::size_t pool = schedule.n_slices * std::size_t{frame.max_depth - 1} * KDRAY_POOL_FIELDS *
                             frame.pool_capacity * sizeof(float);
    const std::size_t shadow =
        schedule.n_slices * std::size_t{KDRAY_SHADOW_FIELDS} * frame.shadow_capacity * sizeof(float);
    EXPECT_LE(std::max(pool, shadow), limit);
    EXPECT_GE(schedule.n_slices, 1u);
    EXPECT_GT(std::max(pool, shadow), limit / 4);
  }
  Schedule ample = wanted;
  ample.fit(scene_frame, hall.features, std::size_t{1} << 40);
  EXPECT_EQ(ample.n_slices, wanted.n_slices);
  EXPECT_EQ(ample.batch_size, wanted.batch_size);
}

KDRAY_FOR_EACH_DEVICE(ScheduleTest);

}  // namespace
}  // namespace kdray::wavefront
