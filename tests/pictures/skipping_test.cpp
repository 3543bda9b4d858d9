// What    What exact rules of skipping leave out changes no bit of the picture, and they do leave something
//         out (docs/design/skipping.md). They are switched off by the mask that kernels are compiled with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "layout/features.h"
#include "oracle/build_scene.h"
#include "pictures/render.h"
#include "pictures/scenes.h"

namespace kdray::test {
namespace {

constexpr int kWidth = 96, kHeight = 65;

bool same_bits(const Picture& a, const Picture& b) {
  return a.rgb.size() == b.rgb.size() &&
         std::memcmp(a.rgb.data(), b.rgb.data(), a.rgb.size() * sizeof(float)) == 0;
}

// A frame for which what these rules skip is done all the same.
Picture keeping(Renderer& renderer, std::uint32_t rules,
                const RenderOptions& options = exact_options(kWidth, kHeight)) {
  api::keep(renderer, rules);
  return renderer.render(options);
}

std::uint64_t skipped(const Renderer& renderer, const char* why) {
  return statistics_of(renderer)["rays"]["skipped"][why];
}

// A mirroring floor with a sphere and a cone on it, seen from just above; lights high and low, near and far,
// one below the floor.
scene::Scene floor_show() {
  scene::Material mirror = oracle::matte(vec3(0.5f));
  mirror.reflect = vec3(0.4f), mirror.specular = vec3(0.3f), mirror.shine = 20;
  oracle::SceneBuilder b;
  b.quad({-8, 0, 8}, {16, 0, 0}, {0, 0, -16}, mirror);
  b.sphere({0, 1, 0}, 1, mirror);
  b.cone({2, 0, 1}, 0.7, {2, 2, 1}, 0.1, mirror);
  b.background({0.1f, 0.3f, 0.6f}).camera({-6, 0.9, 7}, {0, 0.7, 0}, 0.7);
  for (const dvec3& place : {dvec3{3, 6, 4}, {-7.9, 0.2, -7.9}, {0, 40, 0}, {1, -2, 1}, {30, 0.001, 0}})
    b.light(place, vec3(0.4f));
  return b.scene();
}

class EachRule : public testing::TestWithParam<std::uint32_t> {};

TEST_P(EachRule, ChangesNoBit) {
  const Scene scene{floor_show()};
  Renderer renderer(scene, {}, device_of());
  const Picture usual = keeping(renderer, 0);
  ASSERT_GT(mean_luminance(usual), 0.05);
  EXPECT_TRUE(same_bits(usual, keeping(renderer, GetParam())));
}

INSTANTIATE_TEST_SUITE_P(Skipping, EachRule,
                         testing::Values(KDRAY_KEEP_FRUSTUM, KDRAY_KEEP_OCCLUDER, KDRAY_KEEP_NEARNESS,
                                         KDRAY_KEEP_BEYOND, KDRAY_KEEP_BEHIND, KDRAY_KEEP_UNLIT,
                                         KDRAY_KEEP_WEIGHTLESS, KDRAY_KEEP_LEFT, KDRAY_KEEP_OPEN));

class AllRules : public testing::TestWithParam<NamedScene> {};

TEST_P(AllRules, ChangeNoBit) {
  const scene::Scene model = GetParam().make();
  // Where a shadow ray may start behind its triangle.
  const bool smooth = (!model.normals.empty() || !model.instances.empty()) && !model.lights.empty();
  const Scene scene{scene::Scene(model)};
  Renderer renderer(scene, {}, device_of());
  const Picture usual = keeping(renderer, 0);
  const std::uint32_t all = KDRAY_KEEP_ALL & ~(smooth ? KDRAY_KEEP_LEFT : 0u);
  EXPECT_TRUE(same_bits(usual, keeping(renderer, all)));
}

INSTANTIATE_TEST_SUITE_P(Skipping, AllRules, testing::ValuesIn(small_scenes()),
                         [](const auto& info) { return info.param.name; });
INSTANTIATE_TEST_SUITE_P(Textured, AllRules,
                         testing::Values(NamedScene{"textured", textured}, NamedScene{"mapped", mapped},
                                         NamedScene{"soft_light", soft_light},
                                         NamedScene{"under_a_sky", under_a_sky},
                                         NamedScene{"instanced", instanced},
                                         NamedScene{"instanced_maps", instanced_maps}),
                         [](const auto& info) { return info.param.name; });

// Reflected and refracted rays start beside the flat triangle, whatever its normals are.
TEST(Skipping, OfTheTriangleThatIsLeftIsExactForSmoothOnesWithoutLights) {
  const std::vector<NamedScene>& scenes = small_scenes();
  const auto smooth = std::find_if(scenes.begin(), scenes.end(),
                                   [](const NamedScene& s) { return s.name == "smooth_meshes"; });
  ASSERT_NE(smooth, scenes.end());
  scene::Scene model = smooth->make();
  ASSERT_FALSE(model.normals.empty());
  model.lights.clear();
  for (scene::Material& m : model.materials) m.emission = {0.1f, 0.2f, 0.3f}, m.reflect = {0.5f, 0.5f, 0.5f};
  const Scene scene{std::move(model)};
  Renderer renderer(scene, {}, device_of());
  const Picture usual = keeping(renderer, 0);
  ASSERT_GT(mean_luminance(usual), 0.05);
  EXPECT_TRUE(same_bits(usual, keeping(renderer, KDRAY_KEEP_LEFT)));
}

TEST(Skipping, ChangesNoBitInODPRT) {
  const Scene scene{floor_show()};
  Renderer renderer(scene, {}, device_of({.queues = 2}));
  RenderOptions o = exact_options(kWidth, kHeight);
  o.mode = Mode::odprt;
  const Picture picture = keeping(renderer, 0, o);
  EXPECT_GT(skipped(renderer, "light_in_the_open"), 0u);
  EXPECT_TRUE(same_bits(picture, keeping(renderer, KDRAY_KEEP_ALL, o)));
}

TEST(Skipping, LeavesOutWhatPassesTheCore) {
  const Scene scene{floor_show()};
  Renderer renderer(scene, {}, device_of());
  keeping(renderer, 0);
  const std::uint64_t shadow = statistics_of(renderer)["rays"]["shadow"];
  const std::uint64_t reflected = statistics_of(renderer)["rays"]["reflected"];
  const std::uint64_t open = skipped(renderer, "light_in_the_open");
  const std::uint64_t background = skipped(renderer, "of_the_background");
  EXPECT_GT(open, 1000u);
  EXPECT_GT(background, 500u);
  keeping(renderer, KDRAY_KEEP_OPEN);
  EXPECT_EQ(statistics_of(renderer)["rays"]["shadow"], shadow + open);
  EXPECT_EQ(statistics_of(renderer)["rays"]["reflected"], reflected + background);
  EXPECT_EQ(skipped(renderer, "light_in_the_open") + skipped(renderer, "of_the_background"), 0u);
}

TEST(Skipping, TracesEverythingWithoutLeastWeight) {
  const Scene scene{floor_show()};
  Renderer renderer(scene, {}, device_of());
  RenderOptions o = exact_options(kWidth, kHeight);
  o.min_weight = 0;
  keeping(renderer, 0, o);
  EXPECT_EQ(skipped(renderer, "light_in_the_open") + skipped(renderer, "of_the_background"), 0u);
}

}  // namespace
}  // namespace kdray::test
