// What    The same picture bit for bit whatever the tiles, the work-group, the number of queues, how they
//         divide the tiles, which of them fail, and the run (docs/modes.md).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "pictures/render.h"
#include "pictures/scenes.h"

namespace kdray::test {
namespace {

constexpr int kWidth = 150, kHeight = 101;  // no multiple of any tile

struct Schedule {
  int tile_width, tile_height, work_group, queues;
};

Picture render(const Scene& scene, const Schedule& s, const std::vector<std::string>& channels = {}) {
  DeviceOptions device;
  device.queues = s.queues;
  device.work_group = s.work_group;
  Renderer renderer(scene, {}, device_of(device));
  RenderOptions options = exact_options(kWidth, kHeight);
  options.tile_width = s.tile_width;
  options.tile_height = s.tile_height;
  options.channels = channels;
  return renderer.render(options);
}

class Identical : public testing::TestWithParam<NamedScene> {};

TEST_P(Identical, WhateverTheSchedule) {
  const Scene scene{GetParam().make()};
  const Picture first = render(scene, {0, 0, 0, 1});
  ASSERT_EQ(first.rgb.size(), 3u * kWidth * kHeight);
  ASSERT_GT(mean_luminance(first), 0.05);
  for (const int queues : {1, 2}) {
    for (const int work_group : {1, 16, 64}) {
      for (const auto& [width, height] : {std::pair{8, 8}, {16, 16}, {64, 32}}) {
        const Picture other = render(scene, {width, height, work_group, queues});
        EXPECT_TRUE(same_bits(first.rgb, other.rgb))
            << fmt::format("tiles {}x{}, work-group {}, queues {}", width, height, work_group, queues);
      }
    }
  }
}

// GPUs' schedule on any device, with one queue and several, and queries by it.
TEST_P(Identical, WhateverTheKindOfLaunches) {
  const Scene scene{GetParam().make()};
  const Picture first = render(scene, {0, 0, 0, 1});
  for (const kdray::Schedule schedule : {kdray::Schedule::slices, kdray::Schedule::global})
    for (const int queues : {1, 2}) {
      Renderer renderer(scene, {}, device_of({.queues = queues, .schedule = schedule}));
      const Picture other = renderer.render(exact_options(kWidth, kHeight));
      EXPECT_TRUE(same_bits(first.rgb, other.rgb))
          << fmt::format("schedule {}, queues {}", static_cast<int>(schedule), queues);
    }
}

TEST_P(Identical, WhateverTheDivision) {
  const Scene scene{GetParam().make()};
  const Picture first = render(scene, {0, 0, 0, 1});
  for (const int queues : {1, 2, 3, 8}) {
    Renderer renderer(scene, {}, device_of({.queues = queues}));
    for (const Division division : {Division::bag, Division::contiguous, Division::interleaved}) {
      for (const int tile : {0, 4, 50}) {
        RenderOptions options = exact_options(kWidth, kHeight);
        options.division = division;
        options.tile_width = options.tile_height = tile;
        EXPECT_TRUE(same_bits(first.rgb, renderer.render(options).rgb))
            << fmt::format("division {}, tiles {}, queues {}", static_cast<int>(division), tile, queues);
      }
    }
  }
}

TEST_P(Identical, WhateverQueuesFail) {
  const Scene scene{GetParam().make()};
  const Picture first = render(scene, {0, 0, 0, 1});
  for (const char* const faults : {"0@1", "1@1,2@2", "0@2,2@1"}) {
    Renderer renderer = api::make_renderer(scene, {}, device_of({.queues = 3}), {.faults = faults});
    RenderOptions options = exact_options(kWidth, kHeight);
    options.division = Division::interleaved;
    const Picture picture = renderer.render(options);
    const auto quarantined = statistics_of(renderer).at("mode").at("quarantined");
    const auto n = static_cast<std::size_t>(std::count(faults, faults + std::strlen(faults), '@'));
    EXPECT_TRUE(same_bits(first.rgb, picture.rgb)) << faults;
    EXPECT_EQ(picture.warnings.size(), n);
    EXPECT_EQ(quarantined.size(), n);
    // The next frame tries all queues again.
    EXPECT_TRUE(same_bits(first.rgb, renderer.render(options).rgb));
    EXPECT_TRUE(statistics_of(renderer).at("mode").at("quarantined").empty());
  }
}

TEST_P(Identical, FromRunToRunAndWithChannels) {
  const Scene scene{GetParam().make()};
  const Schedule schedule{16, 16, 0, 2};
  const std::vector<std::string> names = {"depth", "normal", "primitive"};
  const Picture first = render(scene, schedule, names), again = render(scene, schedule, names);
  EXPECT_TRUE(same_bits(first.rgb, again.rgb));
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "primitive"})
    EXPECT_TRUE(same_bits(channel(first, name), channel(again, name))) << name;
  EXPECT_TRUE(same_bits(first.rgb, render(scene, schedule).rgb)) << "channels change the colour";
}

TEST_P(Identical, OneRendererTwice) {
  const Scene scene{GetParam().make()};
  Renderer renderer(scene, {}, device_of());
  const Picture first = renderer.render(exact_options(kWidth, kHeight));
  const Picture small = renderer.render(exact_options(16, 9));  // leaves nothing behind for the next
  EXPECT_EQ(small.rgb.size(), 3u * 16 * 9);
  EXPECT_TRUE(same_bits(first.rgb, renderer.render(exact_options(kWidth, kHeight)).rgb));
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, Identical,
    testing::Values(NamedScene{"spheres_and_glass", glass_and_mirror_balls},
                    NamedScene{"smooth_meshes", smooth_meshes}, NamedScene{"cones", cones_and_cylinders},
                    NamedScene{"textured", textured}, NamedScene{"mapped", mapped},
                    NamedScene{"soft_light", soft_light}, NamedScene{"under_a_sky", under_a_sky},
                    NamedScene{"instanced", instanced}, NamedScene{"instanced_maps", instanced_maps}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace kdray::test
