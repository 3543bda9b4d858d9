// What    Adaptive sampling through the public interface: the same bits in every mode, samples where they are
//         needed, an error that is what it is believed to be.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "pictures/render.h"
#include "pictures/scenes.h"

namespace kdray::test {
namespace {

constexpr int kWidth = 90, kHeight = 61;  // no multiple of any tile
constexpr double kTarget = 0.01;

struct Shot {
  Picture picture;
  nlohmann::json statistics;

  const nlohmann::json& samples() const { return statistics["samples"]; }
  const nlohmann::json& quarantined() const { return statistics["mode"]["quarantined"]; }
};

RenderOptions options_for(double target, int samples = 1) {
  RenderOptions o = exact_options(kWidth, kHeight, 4);
  o.samples = samples;
  o.adaptive_target = target;
  return o;
}

Shot render(const Scene& scene, const RenderOptions& options, const DeviceOptions& device = {},
            const api::Hooks& hooks = {}) {
  Renderer renderer = api::make_renderer(scene, {}, device_of(device), hooks);
  Picture picture = renderer.render(options);
  return {std::move(picture), statistics_of(renderer)};
}

double rmse(const Picture& a, const Picture& b) {
  double squares = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    const double d = static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i]);
    squares += d * d;
  }
  return std::sqrt(squares / static_cast<double>(a.rgb.size()));
}

class Adaptive : public testing::TestWithParam<NamedScene> {
 protected:
  const Scene scene{GetParam().make()};
};

TEST_P(Adaptive, TheSameBitsInEveryMode) {
  const Shot first = render(scene, options_for(kTarget));
  ASSERT_GT(first.samples()["rounds"], 1);
  const auto expect_same = [&](const RenderOptions& options, const DeviceOptions& device,
                               const std::string& what) {
    const Shot other = render(scene, options, device);
    EXPECT_TRUE(same_bits(first.picture.rgb, other.picture.rgb)) << what;
    EXPECT_EQ(first.samples(), other.samples()) << what;
  };
  for (const int queues : {2, 3})
    for (const Division division : {Division::bag, Division::interleaved}) {
      RenderOptions options = options_for(kTarget);
      options.division = division;
      options.tile_width = 8 * queues, options.tile_height = 16;
      expect_same(options, {.queues = queues}, fmt::format("pdprt, {} queues", queues));
    }
  for (const Traversal traversal : {Traversal::binary, Traversal::wide, Traversal::packet}) {
    // The automatic walk has the code of packets.
    if (traversal == Traversal::packet && GetParam().name != "every_kind") continue;
    RenderOptions options = options_for(kTarget);
    options.traversal = traversal;
    expect_same(options, {}, fmt::format("traversal {}", static_cast<int>(traversal)));
  }
  for (const int queues : {1, 3}) {
    RenderOptions options = options_for(kTarget);
    options.mode = Mode::odprt;
    expect_same(options, {.queues = queues}, fmt::format("odprt, {} queues", queues));
  }
}

// A queue's share of the tiles brings about its first launch; whether it comes to a fourth is left to chance.
// The picture is not.
TEST_P(Adaptive, TheSameBitsWhateverQueuesFail) {
  const Shot first = render(scene, options_for(kTarget));
  for (const Mode mode : {Mode::pdprt, Mode::odprt})
    for (const std::string faults : {"0@1", "1@3,2@5", "0@4"}) {
      SCOPED_TRACE(fmt::format("mode {}, faults {}", static_cast<int>(mode), faults));
      RenderOptions options = options_for(kTarget);
      options.mode = mode;
      if (mode == Mode::pdprt) options.division = Division::interleaved;
      const Shot other = render(scene, options, {.queues = 3}, {.faults = faults});
      EXPECT_TRUE(same_bits(first.picture.rgb, other.picture.rgb));
      EXPECT_EQ(other.picture.warnings.size(), other.quarantined().size());
      if (faults == "0@1") {
        EXPECT_FALSE(other.picture.warnings.empty());
      }
    }
}

TEST_P(Adaptive, ItsErrorIsWhatItBelieves) {
  const Shot reference = render(scene, options_for(0, 256));
  for (const double target : {0.02, 0.01, 0.005}) {
    const Shot shot = render(scene, options_for(target));
    const double believed = shot.samples()["estimated_rmse"], error = rmse(shot.picture, reference.picture);
    RecordProperty(fmt::format("{}_{}", GetParam().name, target), fmt::format("{} {}", believed, error));
    EXPECT_LT(error, 2 * believed) << target;
    EXPECT_GT(error, 0.4 * believed) << target;
    EXPECT_EQ(shot.samples()["stopped"], believed <= target ? "target" : "cap");
  }
}

TEST_P(Adaptive, IsBetterThanUniformForTheSameSamples) {
  const Shot reference = render(scene, options_for(0, 256)), four = render(scene, options_for(0, 4));
  const double error_of_four = rmse(four.picture, reference.picture);
  const Shot shot = render(scene, options_for(0.5 * error_of_four));
  // What is everywhere, as the noise of soft light or a fine picture, leaves less to save: half of the error
  // takes 8 to 16 samples.
  EXPECT_LT(shot.samples()["per_pixel"], 12.0);
  EXPECT_LT(rmse(shot.picture, reference.picture), error_of_four);
}

INSTANTIATE_TEST_SUITE_P(Light, Adaptive,
                         testing::Values(NamedScene{"soft_light", soft_light},
                                         NamedScene{"under_a_sky", under_a_sky}),
                         [](const auto& info) { return info.param.name; });
INSTANTIATE_TEST_SUITE_P(Pictures, Adaptive, testing::Values(NamedScene{"mapped", mapped}),
                         [](const auto& info) { return info.param.name; });
INSTANTIATE_TEST_SUITE_P(Scenes, Adaptive, testing::ValuesIn(small_scenes()),
                         [](const auto& info) { return info.param.name; });

TEST(AdaptiveFrame, AFlatPictureTakesTheFirstRoundAlone) {
  scene::Scene model;
  model.background = vec3(0.25f, 0.5f, 0.75f);
  model.camera = scene::Camera{};
  model.materials.emplace_back();
  model.spheres.push_back({.center = dvec3(0, 0, 20), .radius = 1});  // behind the camera
  const Scene scene{std::move(model)};
  const Shot shot = render(scene, options_for(1e-6));
  EXPECT_EQ(shot.samples()["total"], kWidth * kHeight);
  EXPECT_EQ(shot.samples()["rounds"], 1);
  EXPECT_EQ(shot.samples()["stopped"], "target");
  EXPECT_EQ(shot.samples()["estimated_rmse"], 0.0);
}

TEST(AdaptiveFrame, TheSamplesChannelSaysWhereTheyWent) {
  const Scene scene{glass_and_mirror_balls()};
  RenderOptions options = options_for(kTarget);
  options.channels = {"samples", "depth"};
  const Shot shot = render(scene, options);
  const std::vector<float>& counts = channel(shot.picture, "samples");
  ASSERT_EQ(counts.size(), std::size_t{kWidth} * kHeight);
  double sum = 0;
  for (const float n : counts) {
    EXPECT_TRUE(n == 1 || n == 4 || n == 8 || n == 16 || n == 32 || n == 64) << n;
    sum += static_cast<double>(n);
  }
  EXPECT_EQ(shot.samples()["total"], sum);
  EXPECT_EQ(shot.statistics["rays"]["primary"], sum);
  EXPECT_EQ(channel(shot.picture, "depth").size(), counts.size());
  options = options_for(0, 4);
  options.channels = {"samples"};
  const Shot uniform = render(scene, options);
  for (const float n : channel(uniform.picture, "samples")) EXPECT_EQ(n, 4);
}

TEST(AdaptiveFrame, SmallRayBuffersChangeNothing) {
  const Scene scene{glass_and_mirror_balls()};
  RenderOptions options = options_for(0.02);
  const Shot first = render(scene, options);
  options.mode = Mode::odprt;
  options.ray_buffer = 64;
  EXPECT_TRUE(same_bits(first.picture.rgb, render(scene, options, {.queues = 2}).picture.rgb));
}

}  // namespace
}  // namespace kdray::test
