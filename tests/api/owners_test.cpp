// What    Channel "queue" against what the statistics say of each queue, and against boxes that are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "io/image/color.h"
#include "kdray/kdray.h"
#include "scene/model/scene.h"
#include "support/device.h"

namespace kdray {
namespace {

class Owners : public test::EachDevice {
 protected:
  Renderer renderer(const Scene& scene, int queues) {
    DeviceOptions options;
    options.device = GetParam();
    options.queues = queues;
    return Renderer(scene, {}, options);
  }
};

// Two heaps of spheres far apart, of which a fair division gives one to each of two queues.
Scene two_heaps() {
  scene::Scene s;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const double side = i % 2 == 0 ? -10 : 10, k = i / 2;
    s.spheres.push_back({.center = {side + std::cos(k) * 3, std::sin(1.7 * k) * 3, std::sin(2.3 * k) * 3},
                         .radius = 0.3,
                         .material = 0,
                         .number = i});
  }
  s.materials.push_back({.emission = vec3(0.5f)});
  s.camera = scene::Camera{.from = {0, 0, 60}, .at = {0, 0, 0}, .up = {0, 1, 0}, .vertical_fov = 0.5};
  return Scene(std::move(s));
}

std::map<float, std::size_t> counted(const std::vector<float>& values) {
  std::map<float, std::size_t> counts;
  for (const float v : values) ++counts[v];
  return counts;
}

TEST_P(Owners, OfTilesAreAsManyAsTheStatisticsSay) {
  constexpr int kSide = 128, kTile = 16;
  for (const Division division : {Division::bag, Division::interleaved, Division::contiguous}) {
    Renderer r = renderer(two_heaps(), 2);
    RenderOptions options{.width = kSide, .height = kSide, .mode = Mode::pdprt, .channels = {"queue"}};
    options.division = division;
    options.tile_width = options.tile_height = kTile;
    const Picture p = r.render(options);
    ASSERT_EQ(p.channels.size(), 1u);
    ASSERT_EQ(p.channels[0].name, "queue");
    auto counts = counted(p.channels[0].values);
    for (const Statistics::Queue& q : r.statistics().mode.division->per_queue) {
      EXPECT_EQ(counts[static_cast<float>(q.number)], *q.tiles * kTile * kTile);
      counts.erase(static_cast<float>(q.number));
    }
    EXPECT_TRUE(counts.empty());
    for (std::size_t i = 0; i < p.channels[0].values.size(); ++i) {
      const std::size_t corner = i / kSide / kTile * kTile * kSide + i % kSide / kTile * kTile;
      EXPECT_EQ(p.channels[0].values[i], p.channels[0].values[corner]) << "a tile is one queue's";
    }
  }
}

TEST_P(Owners, OfSubtreesLieWhereTheyAre) {
  constexpr int kWidth = 96, kHeight = 64;
  Renderer r = renderer(two_heaps(), 2);
  for (const bool beside : {false, true}) {
    RenderOptions options{.width = kWidth, .height = kHeight, .mode = Mode::odprt, .channels = {"queue"}};
    if (beside) options.channels = {"queue", "depth", "samples"};
    const Picture p = r.render(options);
    ASSERT_EQ(p.channels.size(), beside ? 3u : 1u);
    const auto queue = std::ranges::find(p.channels, "queue", &Channel::name);
    ASSERT_NE(queue, p.channels.end());
    std::map<float, std::size_t> left, right;
    for (std::size_t i = 0; i < queue->values.size(); ++i)
      ++(i % kWidth < kWidth / 2 ? left : right)[queue->values[i]];
    EXPECT_GT(left[image::kNoQueue], 100u) << "the background is nobody's";
    // Equal costs don't part them exactly, and some of both is held by all.
    const auto mostly = [](const std::map<float, std::size_t>& half) {
      double all = 0;
      std::pair<float, std::size_t> most{image::kNoQueue, 0};
      for (const auto& [whose, n] : half) {
        if (whose < 0) continue;
        all += static_cast<double>(n);
        if (n > most.second) most = {whose, n};
      }
      EXPECT_GT(static_cast<double>(most.second), 0.75 * all);
      return most.first;
    };
    EXPECT_EQ(mostly(left) + mostly(right), 1) << "a heap is mostly one queue's";
  }
}

TEST_P(Owners, OfOneQueueAreThatQueue) {
  Renderer r = renderer(two_heaps(), 1);
  const Picture p = r.render({.width = 40, .height = 30, .channels = {"queue"}});
  for (const float v : p.channels[0].values) EXPECT_EQ(v, 0);
}

KDRAY_FOR_EACH_DEVICE(Owners);

}  // namespace
}  // namespace kdray
