// What    What exact rules of skipping leave out changes no bit of the picture, and they do leave something
//         out (docs/design/skipping.md). They are switched off by the mask that kernels are compiled with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "layout/features.h"
#include "oracle/build_scene.h"
#include "pictures/render.h"
#include "pictures/scenes.h"
#include "scene/generate/random.h"
#include "scene/generate/rotation.h"

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

std::uint64_t empty_samples(const Renderer& renderer) {
  return statistics_of(renderer)["mode"]["samples_of_empty_blocks"];
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

// Without faces: balls over the studio's floor, tilted, which mirrors a little, under a sky; lights above it,
// beside it and below it, and a lamp with an area.
scene::Scene floor_of_studio() {
  oracle::SceneBuilder b;
  const scene::Material matte = oracle::matte(vec3(0.5f));
  b.sphere({0, 1, 0}, 1, matte).sphere({1.7, 0.5, 0.4}, 0.5, matte);
  b.background({0.1f, 0.3f, 0.6f}).camera({-6, 1.9, 7}, {0, 0.7, 0}, 0.7);
  for (const dvec3& place : {dvec3{3, 6, 4}, {-0.5, 9, 0.2}, {1, -2, 1}, {5, 0.3, 0}})
    b.light(place, vec3(0.4f));
  scene::Light lamp;
  lamp.kind = scene::LightKind::sphere;
  lamp.position = {-4, 3, 2}, lamp.radius = 0.8, lamp.color = {0.4f, 0.4f, 0.3f};
  scene::Scene scene = b.light(lamp).scene();
  scene.sky = {.kind = scene::SkyKind::gradient,
               .stops = {{-1, {0.2f, 0.2f, 0.3f}}, {1, {0.9f, 0.8f, 0.7f}}}};
  scene.sky.brightest = scene::brightest_of(scene.sky);
  scene.framing.floor = {.up = glm::normalize(dvec3(0.1, 1, -0.05)),
                         .inner = 2,
                         .radius = 8,
                         .diffuse = vec3(0.6f),
                         .reflect = 0.2f};
  return scene;
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
                                         KDRAY_KEEP_WEIGHTLESS, KDRAY_KEEP_LEFT, KDRAY_KEEP_OPEN,
                                         KDRAY_KEEP_EMPTY));

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

class PassingTheCore : public testing::TestWithParam<NamedScene> {};

TEST_P(PassingTheCore, IsLeftOut) {
  const Scene scene{GetParam().make()};
  Renderer renderer(scene, {}, device_of());
  const Picture usual = keeping(renderer, 0);
  const std::uint64_t shadow = statistics_of(renderer)["rays"]["shadow"];
  const std::uint64_t reflected = statistics_of(renderer)["rays"]["reflected"];
  const std::uint64_t open = skipped(renderer, "light_in_the_open");
  const std::uint64_t background = skipped(renderer, "of_the_background");
  EXPECT_GT(open, 1000u);
  EXPECT_GT(background, 500u);
  EXPECT_TRUE(same_bits(usual, keeping(renderer, KDRAY_KEEP_OPEN)));
  EXPECT_EQ(statistics_of(renderer)["rays"]["shadow"], shadow + open);
  EXPECT_EQ(statistics_of(renderer)["rays"]["reflected"], reflected + background);
  EXPECT_EQ(skipped(renderer, "light_in_the_open") + skipped(renderer, "of_the_background"), 0u);
}

TEST_P(PassingTheCore, ChangesNoBitInODPRT) {
  const Scene scene{GetParam().make()};
  Renderer renderer(scene, {}, device_of({.queues = 2}));
  RenderOptions o = exact_options(kWidth, kHeight);
  o.mode = Mode::odprt;
  const Picture picture = keeping(renderer, 0, o);
  EXPECT_GT(skipped(renderer, "light_in_the_open"), 0u);
  EXPECT_TRUE(same_bits(picture, keeping(renderer, KDRAY_KEEP_ALL, o)));
}

TEST_P(PassingTheCore, ChangesNoBitInDouble) {
  const Scene scene{GetParam().make()};
  Renderer renderer(scene, {}, device_of());
  RenderOptions o = exact_options(kWidth / 2, kHeight / 2);
  o.precision = Precision::float64;
  const Picture picture = keeping(renderer, 0, o);
  EXPECT_TRUE(same_bits(picture, keeping(renderer, KDRAY_KEEP_OPEN, o)));
}

INSTANTIATE_TEST_SUITE_P(Skipping, PassingTheCore,
                         testing::Values(NamedScene{"over_a_face", floor_show},
                                         NamedScene{"over_a_studio_s_floor", floor_of_studio}),
                         [](const auto& info) { return info.param.name; });

TEST(Skipping, TracesEverythingWithoutLeastWeight) {
  const Scene scene{floor_show()};
  Renderer renderer(scene, {}, device_of());
  RenderOptions o = exact_options(kWidth, kHeight);
  o.min_weight = 0;
  keeping(renderer, 0, o);
  EXPECT_EQ(skipped(renderer, "light_in_the_open") + skipped(renderer, "of_the_background"), 0u);
  EXPECT_EQ(empty_samples(renderer), 0u);
}

// Balls about few places, so that each place is a leaf of its own, and blocks of pixels lie between them;
// some are less than a pixel wide.
scene::Scene balls_in_the_open(std::uint64_t seed) {
  constexpr int kPlaces = 400, kOfOne = 12;
  generate::Random random(seed);
  scene::Material glow = oracle::matte(vec3(0.5f));
  glow.emission = vec3(0.7f, 0.5f, 0.2f), glow.reflect = vec3(0.3f);
  oracle::SceneBuilder b;
  for (int i = 0; i < kPlaces; ++i) {
    const dvec3 at = random.in_box(dvec3(-10), dvec3(10));
    const double radius = random.between(0.01, 0.06);
    for (int k = 0; k < kOfOne; ++k) b.sphere(at, radius * (1 - 0.01 * k), glow);
  }
  b.background({0.1f, 0.3f, 0.6f});
  return b.scene();
}

// From without and within, along the axes and aslant, narrow as a needle and wide, parallel, through the
// pixels' corners, with several samples, in tiles of other sizes, by two queues; rays of the pool wait while
// the last tiles are empty.
class EmptyBlocks : public testing::TestWithParam<int> {};

TEST_P(EmptyBlocks, ChangeNoBit) {
  const auto seed = static_cast<std::uint64_t>(GetParam());
  generate::Random random(seed);
  scene::Scene model = balls_in_the_open(seed);
  std::uint64_t n_empty = 0;
  for (int i = 0; i < 8; ++i) {
    scene::Camera camera{.from = 40.0 * random.direction(), .at = random.in_box(dvec3(-5), dvec3(5))};
    camera.vertical_fov = i == 5 ? 0.001 : i == 6 ? 2.6 : random.between(0.1, 1.2);
    if (i == 1) camera.from = {0, 0, 30}, camera.at = dvec3(0);
    if (i == 2) camera.from = dvec3(0.5), camera.at = {0.5, 0.5, -9};
    if (i == 3) camera.ortho_width = 25;
    model.camera = camera;
    const Scene scene{scene::Scene(model)};
    Renderer renderer(scene, {}, device_of({.queues = i == 6 ? 2 : 1}));
    RenderOptions o = exact_options(300 + 7 * i, 200);
    o.samples = i == 0 || i == 4 ? 16 : i == 6 ? 3 : 1;
    o.grid = i == 7 ? PixelGrid::corners : PixelGrid::centers;
    if (i % 4 == 1) o.tile_width = 37, o.tile_height = 20;
    if (i % 4 == 3) o.tile_width = 4, o.tile_height = 9;
    const Picture usual = keeping(renderer, 0, o);
    const std::uint64_t empty = empty_samples(renderer);
    EXPECT_EQ(statistics_of(renderer)["rays"]["primary"], o.width * o.height * o.samples);
    EXPECT_TRUE(i != 3 || empty == 0) << "a parallel camera";
    if (statistics_of(renderer)["mode"]["schedule"] != "slices")
      GTEST_SKIP() << "only slices pass over blocks";
    n_empty += empty;
    EXPECT_TRUE(same_bits(usual, keeping(renderer, KDRAY_KEEP_EMPTY, o))) << "seed " << seed << ", " << i;
    EXPECT_EQ(empty_samples(renderer), 0u);
  }
  EXPECT_GT(n_empty, 100000u) << "seed " << seed;
}

INSTANTIATE_TEST_SUITE_P(Skipping, EmptyBlocks, testing::Range(20261128, 20261132));

// Instances that are stretched one to thirty: boxes are widened by more (host/accel/flatten/instances.h).
TEST(Skipping, EmptyBlocksOfStretchedInstancesChangeNoBit) {
  generate::Random random(20261128);
  scene::Scene model = balls_in_the_open(1);
  auto mesh = std::make_shared<scene::Scene>();
  mesh->name = "ball";
  mesh->spheres = {model.spheres.begin(), model.spheres.begin() + 12};
  for (auto& ball : mesh->spheres) ball.center = dvec3(0);
  model.spheres.clear();
  model.meshes.push_back(mesh);
  for (int i = 0; i < 300; ++i) {
    scene::Instance instance;
    const double angle = random.between(0, 3);
    instance.linear =
        generate::rotation_y(angle) * generate::rotation_x(2 * angle) * dmat3(6, 0, 0, 0, 0.2, 0, 0, 0, 1);
    instance.move = random.in_box(dvec3(-10), dvec3(10));
    model.instances.push_back(instance);
  }
  model.camera = scene::Camera{.from = {25, 9, 30}, .at = {0, 0, 0}, .vertical_fov = 0.6};
  const Scene scene{std::move(model)};
  Renderer renderer(scene, {}, device_of());
  RenderOptions o = exact_options(300, 200);
  o.samples = 16;
  const Picture usual = keeping(renderer, 0, o);
  if (statistics_of(renderer)["mode"]["schedule"] != "slices") GTEST_SKIP() << "only slices pass over blocks";
  EXPECT_GT(empty_samples(renderer), 1000u);
  EXPECT_TRUE(same_bits(usual, keeping(renderer, KDRAY_KEEP_EMPTY, o)));
}

TEST(Skipping, AnEmptySceneIsAllBackground) {
  scene::Scene model =
      oracle::SceneBuilder().background({0.25f, 0.5f, 1}).camera({0, 0, 5}, {0, 0, 0}).scene();
  const Scene scene{std::move(model)};
  Renderer renderer(scene, {}, device_of());
  const Picture picture = keeping(renderer, 0);
  for (std::size_t i = 0; i < picture.rgb.size(); ++i)
    ASSERT_EQ(picture.rgb[i], i % 3 == 0 ? 0.25f : i % 3 == 1 ? 0.5f : 1.0f);
}

}  // namespace
}  // namespace kdray::test
