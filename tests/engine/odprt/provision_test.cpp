// What    What a frame takes of a device's memory is what was computed beforehand, and limits are kept or
//         refused in words.
#include "engine/odprt/provision.h"

#include <gtest/gtest.h>

#include "device/opencl/context.h"
#include "engine/odprt/prepared_scenes.h"
#include "engine/odprt/worker_pool.h"
#include "kdray/error.h"
#include "layout/features.h"

namespace kdray::test {
namespace {

layout::Frame frame_of(std::uint32_t side) {
  layout::Frame frame{};
  frame.width = frame.height = side;
  frame.tile_width = frame.tile_height = 32;
  frame.n_tiles_x = (side + 31) / 32;
  frame.n_tiles = frame.n_tiles_x * frame.n_tiles_x;
  frame.n_samples = 1;
  frame.max_depth = 5;
  frame.n_lights = 2;
  return frame;
}

constexpr layout::Features kFeatures =
    KDRAY_FEATURE_KIND(TRIANGLE) | KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT | KDRAY_FEATURE_LIGHTS;

odprt::Request request_of(std::size_t n_queues, std::uint64_t device_memory) {
  odprt::Request request;
  request.queues.resize(n_queues);
  request.table = odprt::alone(n_queues);
  request.frame = frame_of(512);
  request.features = kFeatures;
  request.device_memory = device_memory;
  return request;
}

std::size_t work_of(const odprt::Provision& p) {
  return odprt::work_bytes(p.frame, p.plan, p.capacity.places, p.n_outboxes);
}

TEST(Provision, WithoutALimitThereIsAPartForEachQueue) {
  const odprt::Provision p = odprt::provide(request_of(4, 0), std::size_t{1} << 40);
  EXPECT_EQ(p.n_parts, 4u);
  EXPECT_FALSE(p.streamed);
  EXPECT_EQ(p.bands.size(), 1u);
}

TEST(Provision, ALimitIsKept) {
  for (const std::uint64_t limit : {std::uint64_t{200} << 20, std::uint64_t{300} << 20})
    for (const std::size_t n_queues : {1u, 2u, 3u}) {
      const odprt::Provision p = odprt::provide(request_of(n_queues, limit), std::size_t{400} << 20);
      EXPECT_TRUE(p.streamed);
      EXPECT_LE((work_of(p) + p.most_geometry) * n_queues, limit);
      EXPECT_GE(p.most_geometry * p.n_parts, std::size_t{400} << 20);
      EXPECT_GT(p.n_parts, n_queues);
    }
}

TEST(Provision, WhatFitsIsNotStreamed) {
  const odprt::Provision p = odprt::provide(request_of(2, std::uint64_t{1} << 30), std::size_t{10} << 20);
  EXPECT_FALSE(p.streamed);
}

TEST(Provision, TooLittleIsRefusedWithWhatWouldDo) {
  const auto least_told = [](std::uint64_t limit) -> std::uint64_t {
    try {
      odprt::provide(request_of(2, limit), std::size_t{400} << 20);
      return 0;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::out_of_memory);
      const std::string text = e.what();
      const std::size_t at = text.find("it takes ");
      EXPECT_NE(at, std::string::npos) << text;
      return std::stoull(text.substr(at + 9)) << 20;
    }
  };
  const std::uint64_t least = least_told(2 << 20);
  ASSERT_GT(least, 2u << 20);
  EXPECT_LE(least_told(least * 5 / 4), 0u) << "a quarter more than what it said is refused";
}

// A wave of many lights is many launches: where every ray has a work-item it is to be of many rays.
TEST(Provision, ShadowRaysOfManyLightsHaveRoom) {
  for (const std::size_t n_queues : {1u, 2u}) {
    odprt::Request request = request_of(n_queues, 0);
    request.frame.n_lights = 2000;
    request.wave_rays = 4096;
    const odprt::Provision p = odprt::provide(request, std::size_t{10} << 20);
    EXPECT_GE(p.plan.outbox.shadow, 256u * 2000u);
    EXPECT_GE(p.plan.capacity[0], n_queues * 256u * 2000u);
    EXPECT_LE(work_of(p), std::size_t{512} << 20);
  }
}

TEST(Provision, WorkersTakeWhatWasComputed) {
  const device::Context context("cpu", 1);
  const prepare::Prepared scene = prepare::prepare(smooth_meshes(), TreeOptions());
  wavefront::Programs programs(context, scene.tree_depth, scene.wide);
  for (const auto& [ray_buffer, wave_rays] :
       {std::pair{0u, 0u}, std::pair{1u, 0u}, std::pair{50u, 0u}, std::pair{0u, 4096u}}) {
    odprt::Request request = request_of(1, 0);
    request.queues[0] = {&context, context.queues().front(), &programs, 0};
    request.features = scene.features;
    request.ray_buffer = ray_buffer;
    request.wave_rays = wave_rays;
    const odprt::Provision p = odprt::provide(request, 0);
    const odprt::Cut cut = odprt::cut(scene.flat, scene.wide, 16);
    const std::vector<double> costs(cut.subtrees.size(), 1.0);
    const odprt::Division division = odprt::divide(scene.flat, scene.wide, cut, costs, {});
    const odprt::WorkerPool pool = odprt::make_worker_pool(request, p, division, cut);
    const auto computed = static_cast<double>(work_of(p)),
               taken = static_cast<double>(pool.reports[0].device_bytes);
    EXPECT_GE(taken, 0.98 * computed);
    EXPECT_LE(taken, computed + 65536) << "ray buffer " << ray_buffer;
  }
}

}  // namespace
}  // namespace kdray::test
