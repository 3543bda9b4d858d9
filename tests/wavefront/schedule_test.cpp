// A schedule changes time and memory, never the picture: odd batch, tile, slice and light-batch sizes, one slice, batches
// of one ray, full pools. And the pool's bound is tight enough to be a bound and loose enough to hold.
#include <gtest/gtest.h>

#include "flatten/features.h"
#include "flatten/flatten.h"
#include "flatten/frame.h"
#include "kdray/error.h"
#include "kdtree/build.h"
#include "pdprt/render.h"
#include "support/device.h"

namespace kdray::wavefront {
namespace {

// Glass and mirror spheres in a mirror box: every ray spawns two, to the depth limit.
scene::Scene hall_of_mirrors() {
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
  for (int i = 0; i < 5; ++i)
    s.lights.push_back(
        {.position = {i - 2.0, 2.5, 1.0 - i * 0.3}, .color = vec3(0.1f * static_cast<float>(i + 1))});
  s.camera = scene::Camera{.from = {0, -2.5, 2}, .at = {0, 1, 0}, .up = {0, 0, 1}, .vertical_fov = 1.2};
  return s;
}

struct Prepared {
  scene::Scene scene = hall_of_mirrors();
  scene::Geometry geometry = scene::make_geometry(scene);
  kdtree::Tree tree = kdtree::build(geometry);
  std::uint32_t features = flatten::features_of(scene, geometry);

  pdprt::Result render(const device::Context& context, const Schedule& schedule,
                       double min_weight = 0) const {
    const SceneBuffers buffers(context, flatten::flatten(scene, geometry, tree));
    Programs programs(context, tree.max_depth);
    RenderOptions options;
    options.width = 61;
    options.height = 43;
    options.depth = 7;
    options.min_weight = min_weight;
    const layout::Frame frame = flatten::make_frame(scene, geometry, flatten::resolved(options, {}));
    return pdprt::render(context, buffers, programs, frame, schedule, features, {});
  }
};

class ScheduleTest : public test::EachDevice {};

TEST_P(ScheduleTest, NoScheduleChangesThePicture) {
  const Prepared prepared;
  const device::Context context(GetParam(), 1);
  const pdprt::Result reference = prepared.render(context, Schedule{});
  EXPECT_GT(reference.counters.refracted, 5000u);
  const Schedule schedules[] = {
      {.tile_width = 1, .tile_height = 1, .batch_size = 1, .n_slices = 7, .light_batch = 1, .work_group = 1},
      {.tile_width = 8, .tile_height = 8, .batch_size = 3, .n_slices = 1, .light_batch = 2, .work_group = 16},
      {.tile_width = 64,
       .tile_height = 64,
       .batch_size = 1000,
       .n_slices = 5,
       .light_batch = 5,
       .work_group = 64},
      {.tile_width = 5,
       .tile_height = 17,
       .batch_size = 31,
       .n_slices = 33,
       .light_batch = 3,
       .work_group = 7},
  };
  for (const Schedule& schedule : schedules) {
    const pdprt::Result result = prepared.render(context, schedule);
    EXPECT_EQ(result.image.pixels, reference.image.pixels) << "batch of " << schedule.batch_size;
    EXPECT_EQ(result.counters.total(), reference.counters.total());
    EXPECT_EQ(result.counters.shadow, reference.counters.shadow);
    EXPECT_EQ(result.counters.pool_overflow, 0u);
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
  const pdprt::Result cut = prepared.render(context, Schedule{}, kStep);
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
  const SceneBuffers buffers(context, flatten::flatten(prepared.scene, prepared.geometry, prepared.tree));
  Programs programs(context, prepared.tree.max_depth);
  RenderOptions options;
  options.width = options.height = 32;
  layout::Frame frame =
      flatten::make_frame(prepared.scene, prepared.geometry, flatten::resolved(options, {}));
  const Schedule schedule{.n_slices = 1};
  schedule.apply(frame, prepared.features);
  frame.pool_size = 10;
  Wavefront wavefront(context, context.queues().front(), buffers, programs, frame, schedule,
                      prepared.features, 32 * 32);
  EXPECT_THROW((void)wavefront.render_tiles(0, frame.n_tiles, 0, 32 * 32, [](std::uint32_t) {}), Error);
}

KDRAY_FOR_EACH_DEVICE(ScheduleTest);

}  // namespace
}  // namespace kdray::wavefront
