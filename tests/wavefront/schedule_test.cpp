// A schedule changes time and memory, never the picture: odd batch, tile, slice and light-batch sizes, one slice, batches
// of one ray, full pools, a launch per stage or for all of them; with more lights than a round serves, every kind of
// primitive, several samples, and pictures of one pixel. And the pool's bound is tight enough to be a bound and loose enough
// to hold.
#include <gtest/gtest.h>

#include "flatten/features.h"
#include "flatten/flatten.h"
#include "flatten/frame.h"
#include "flatten/wide.h"
#include "kdray/error.h"
#include "kdtree/build.h"
#include "pdprt/render.h"
#include "support/device.h"

namespace kdray::wavefront {
namespace {

// Glass and mirror spheres and cones and a smooth sail in a mirror box: every ray spawns two, to the depth limit.
scene::Scene hall_of_mirrors(int n_lights = 11) {
  scene::Scene s;
  s.vertices = {{-3, -3, -3}, {3, -3, -3}, {3, 3, -3}, {-3, 3, -3},
                {-3, -3, 3},  {3, -3, 3},  {3, 3, 3},  {-3, 3, 3}};
  const std::uint32_t quads[6][4] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1},
                                     {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
  std::uint32_t number = 0;
  for (const auto& q : quads)
    for (const auto& corner : {std::array{q[0], q[1], q[2]}, std::array{q[0], q[2], q[3]}}) {
      scene::Triangle t;
      t.vertex = corner;
      t.number = number++;
      s.triangles.push_back(t);
    }
  s.materials = {{.ambient = vec3(0.05f, 0.1f, 0.02f), .diffuse = vec3(0.3f), .reflect = vec3(0.5f)},
                 {.specular = vec3(0.5f),
                  .reflect = vec3(0.4f),
                  .transmit = vec3(0.5f, 0.4f, 0.3f),
                  .shine = 20,
                  .index = 1.5f}};
  for (int i = 0; i < 5; ++i) {
    scene::Sphere sphere{
        .center = {i - 2.0, 0.3 * i - 0.5, 0.4 * i - 1}, .radius = 0.6, .material = 1, .number = number++};
    s.spheres.push_back(sphere);
  }
  s.cones.push_back({.base = {-2, 1.5, -2.5},
                     .apex = {-1.8, 1.7, 1.2},
                     .base_radius = 0.7,
                     .apex_radius = 0.1,
                     .material = 1,
                     .number = number++});
  s.vertices.insert(s.vertices.end(), {{1, 1.6, -1}, {2.4, 1.4, -0.8}, {1.7, 1.8, 1.3}});
  s.normals = {{-0.48f, -0.8f, -0.36f}, {0.48f, -0.8f, -0.36f}, {0, -0.8f, 0.6f}};
  scene::Triangle sail;
  sail.vertex = {8, 9, 10};
  sail.normal = {0, 1, 2};
  sail.material = 1;
  sail.number = number++;
  s.triangles.push_back(sail);
  for (int i = 0; i < n_lights; ++i)
    s.lights.push_back({.position = {0.5 * i - 2.5, 2.5 - 0.1 * i, 1.0 - i * 0.3},
                        .color = vec3(0.05f * static_cast<float>(i + 1))});
  s.camera = scene::Camera{.from = {0, -2.5, 2}, .at = {0, 1, 0}, .up = {0, 0, 1}, .vertical_fov = 1.2};
  return s;
}

struct Prepared {
  scene::Scene scene = hall_of_mirrors();
  scene::Geometry geometry = scene::make_geometry(scene);
  kdtree::Tree tree = kdtree::build(geometry);
  flatten::FlatScene flat = flatten::flatten(scene, geometry, tree);
  flatten::WideForm wide = flatten::make_wide(tree, flat, flatten::choose_block(tree));
  std::uint32_t features = flatten::features_of(scene, geometry);

  static RenderOptions options() {
    RenderOptions o;
    o.width = 61;
    o.height = 43;
    o.depth = 7;
    o.min_weight = 0;
    return o;
  }

  pdprt::Result render(const device::Context& context, const Schedule& schedule,
                       const RenderOptions& o = options()) const {
    const SceneBuffers buffers(context, flat, wide);
    Programs programs(context, tree.max_depth, wide);
    const RenderOptions full = flatten::resolved(o, {});
    const layout::Frame frame = flatten::make_frame(scene, geometry, full);
    return pdprt::render(context, buffers, programs, frame, schedule,
                         features | flatten::features_of_samples(full.samples), {});
  }
};

void expect_same(const pdprt::Result& result, const pdprt::Result& reference) {
  EXPECT_EQ(result.image.pixels, reference.image.pixels);
  const Counters &a = result.counters, &b = reference.counters;
  EXPECT_EQ(a.primary, b.primary);
  EXPECT_EQ(a.primary_hit, b.primary_hit);
  EXPECT_EQ(a.reflected, b.reflected);
  EXPECT_EQ(a.refracted, b.refracted);
  EXPECT_EQ(a.shadow, b.shadow);
  EXPECT_EQ(a.skipped_behind, b.skipped_behind);
  EXPECT_EQ(a.skipped_unlit, b.skipped_unlit);
  EXPECT_EQ(a.skipped_weight, b.skipped_weight);
  EXPECT_EQ(a.skipped_depth, b.skipped_depth);
  EXPECT_EQ(a.pool_overflow, 0u);
}

class ScheduleTest : public test::EachDevice {};

TEST_P(ScheduleTest, NoScheduleChangesThePicture) {
  const Prepared prepared;
  const device::Context context(GetParam(), 1);
  const pdprt::Result reference = prepared.render(context, Schedule{});
  EXPECT_GT(reference.counters.refracted, 5000u);
  EXPECT_EQ(reference.counters.primary, 61u * 43);
  const Schedule schedules[] = {
      {.tile_width = 1, .tile_height = 1, .batch_size = 1, .n_slices = 7, .light_batch = 1},
      {.tile_width = 8, .tile_height = 8, .batch_size = 3, .n_slices = 1, .light_batch = 2},
      {.tile_width = 64, .tile_height = 64, .batch_size = 1000, .n_slices = 5, .light_batch = 5},
      {.tile_width = 5, .tile_height = 17, .batch_size = 31, .n_slices = 33, .light_batch = 3},
      {.tile_width = 100, .tile_height = 1, .batch_size = 16, .n_slices = 3, .light_batch = 100},
  };
  for (Schedule schedule : schedules) {
    SCOPED_TRACE(schedule.batch_size);
    for (const std::uint32_t waves : {1u, 3u, 64u}) {
      schedule.fused_waves = waves;
      expect_same(prepared.render(context, schedule), reference);
    }
    schedule.fused = false;
    for (const std::size_t work_group : {1u, 7u, 64u}) {
      schedule.work_group = work_group;
      expect_same(prepared.render(context, schedule), reference);
    }
  }
}

TEST_P(ScheduleTest, NorDoesItWithSeveralSamplesAPixel) {
  const Prepared prepared;
  const device::Context context(GetParam(), 1);
  for (const int samples : {2, 5, 16, 37}) {
    SCOPED_TRACE(samples);
    RenderOptions options = Prepared::options();
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
  const Prepared prepared;
  const device::Context context(GetParam(), 1);
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 2}, {3, 1}, {17, 1}}) {
    SCOPED_TRACE(width);
    RenderOptions options = Prepared::options();
    options.width = width;
    options.height = height;
    const pdprt::Result reference = prepared.render(context, Schedule{}, options);
    EXPECT_EQ(reference.counters.primary, static_cast<unsigned>(width * height));
    EXPECT_GT(reference.image.pixels[0].x, 0.0f);
    expect_same(prepared.render(context, {.tile_width = 2, .tile_height = 2, .batch_size = 1, .fused = false},
                                options),
                reference);
  }
}

TEST_P(ScheduleTest, DepthOneNeedsNoPool) {
  const Prepared prepared;
  const device::Context context(GetParam(), 1);
  RenderOptions options = Prepared::options();
  options.depth = 1;
  const pdprt::Result flat = prepared.render(context, Schedule{}, options);
  EXPECT_EQ(flat.counters.reflected + flat.counters.refracted, 0u);
  EXPECT_GT(flat.counters.skipped_depth, 0u);
  expect_same(prepared.render(context, {.batch_size = 50, .fused = false}, options), flat);
}

// The stages' seconds are what the launches took, and each stage took some of it.
TEST_P(ScheduleTest, EveryStageIsTimed) {
  const Prepared prepared;
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
  const Prepared prepared;
  const pdprt::Result one = prepared.render(device::Context(GetParam(), 1), Schedule{});
  const Schedule small{.tile_width = 8, .tile_height = 2};
  for (const int queues : {2, 3}) {
    const pdprt::Result many = prepared.render(device::Context(GetParam(), queues), small);
    EXPECT_EQ(many.image.pixels, one.image.pixels) << queues;
    EXPECT_EQ(many.counters.total(), one.counters.total());
    EXPECT_GT(many.n_bands, 1u);
  }
}

TEST_P(ScheduleTest, TheWeightCutSavesRaysAndStaysBelowItsPromise) {
  const Prepared prepared;
  const device::Context context(GetParam(), 1);
  const pdprt::Result full = prepared.render(context, Schedule{});
  constexpr double kStep = 0.25;
  RenderOptions options = Prepared::options();
  options.min_weight = kStep;
  const pdprt::Result cut = prepared.render(context, Schedule{}, options);
  EXPECT_LT(cut.counters.total(), full.counters.total());
  EXPECT_GT(cut.counters.skipped_weight, 0u);
  // Each ray that is left out brings less than the cut; a pixel may lose several.
  double mean = 0;
  for (std::size_t i = 0; i < full.image.pixels.size(); ++i)
    mean += glm::length(full.image.pixels[i] - cut.image.pixels[i]) /
            static_cast<double>(full.image.pixels.size());
  EXPECT_LT(mean, kStep);
}

// The frame's pool taken down to less than the bound must be noticed, not written past.
TEST_P(ScheduleTest, APoolThatIsTooSmallIsAnErrorNotAWrongPicture) {
  const Prepared prepared;
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
                        prepared.features, 32 * 32);
    EXPECT_THROW(wavefront.render_tiles(
                     0, frame.n_tiles, 0, 32 * 32, [](std::uint32_t) {}, [](std::span<const layout::i64>) {}),
                 Error);
  }
}

KDRAY_FOR_EACH_DEVICE(ScheduleTest);

}  // namespace
}  // namespace kdray::wavefront
