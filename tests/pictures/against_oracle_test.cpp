// What    Pictures against the independent double-precision ray tracer: every pixel within 1/255 in linear
//         RGB, but for those whose ray tree takes another path a hundredth of a pixel aside; of these, few
//         may differ.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "oracle/oracle.h"
#include "pictures/like_oracle.h"
#include "pictures/render.h"
#include "pictures/scenes.h"
#include "support/data.h"

namespace kdray::test {
namespace {

constexpr int kSize = 128;

// The rays too are the same ones, within the few that an edge may decide otherwise.
void expect_same_rays(const Renderer& renderer, const oracle::RayCounts& truth) {
  const nlohmann::json rays = statistics_of(renderer).at("rays");
  const auto expect_near = [&](const char* name, double found, std::uint64_t wanted) {
    EXPECT_NEAR(found, static_cast<double>(wanted), 0.003 * static_cast<double>(wanted) + 8) << name;
  };
  EXPECT_EQ(rays.at("primary").get<std::uint64_t>(), truth.primary);
  const auto skipped = [&](const char* why) { return rays.at("skipped").at(why).get<double>(); };
  expect_near("primary_hit", rays.at("primary_hit").get<double>(), truth.primary_hit);
  expect_near("refracted", rays.at("refracted").get<double>(), truth.refracted);
  // What leaves a face past all else, to the background or a light, is known without a ray.
  expect_near("reflected", rays.at("reflected").get<double>() + skipped("of_the_background"),
              truth.reflected);
  // Which lights are too weak for a ray is kdray's to say; that it has looked at each one in front is not.
  const double shadow = rays.at("shadow").get<double>();
  const double open = skipped("light_in_the_open");
  expect_near("shadow", shadow + open + skipped("light_of_no_weight"), truth.light_in_front);
  EXPECT_LE(shadow + open, static_cast<double>(truth.shadow) + 0.003 * static_cast<double>(truth.shadow) + 8);
}

void expect_like_oracle(const scene::Scene& model, const RenderOptions& options) {
  const Scene scene{scene::Scene(model)};
  Renderer renderer(scene, {}, device_of());
  const Picture picture = renderer.render(options);
  const auto grid = options.grid == PixelGrid::corners ? oracle::Grid::corners : oracle::Grid::centers;
  const oracle::OracleResult truth =
      oracle::trace_picture(model, options.width, options.height, options.depth, grid);
  expect_like(picture, truth);
  expect_same_rays(renderer, truth.counts);
}

class BuiltScenes : public testing::TestWithParam<NamedScene> {};

TEST_P(BuiltScenes, LookLikeTheOracles) {
  expect_like_oracle(GetParam().make(), exact_options(kSize, kSize));
}

INSTANTIATE_TEST_SUITE_P(AgainstOracle, BuiltScenes, testing::ValuesIn(small_scenes()),
                         [](const auto& info) { return info.param.name; });

TEST(AgainstOracle, EveryDepth) {
  for (const int depth : {1, 2, 3, 8}) {
    SCOPED_TRACE(depth);
    expect_like_oracle(glass_and_mirror_balls(), exact_options(64, 64, depth));
  }
}

TEST(AgainstOracle, OblongPicturesAndTheCornerGrid) {
  expect_like_oracle(cones_and_cylinders(), exact_options(150, 70));
  expect_like_oracle(cones_and_cylinders(), exact_options(31, 97));
  RenderOptions corners = exact_options(97, 65);
  corners.grid = PixelGrid::corners;
  expect_like_oracle(glass_and_mirror_balls(), corners);
}

TEST(AgainstOracle, ManySamplesAverageToTheSamePicture) {
  // Stratified samples of a 40x40 picture against the mean of the oracle's finer one: the mean error is what
  // 4x4 strata leave at the edges.
  const Scene scene{every_light()};
  Renderer renderer(scene, {}, device_of());
  RenderOptions options = exact_options(40, 40);
  options.samples = 16;
  const Picture picture = renderer.render(options);
  ASSERT_EQ(picture.rgb.size(), 3u * 40 * 40);
  constexpr int kFine = 4;
  const oracle::OracleResult truth = oracle::trace_picture(scene.model(), 40 * kFine, 40 * kFine, 5);
  double sum = 0;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      dvec3 mean(0);
      for (int i = 0; i < kFine * kFine; ++i)
        mean +=
            truth.rgb[(y * kFine + i / kFine) * 40 * kFine + x * kFine + i % kFine] / double(kFine * kFine);
      const float* found = &picture.rgb[3 * (y * 40 + x)];
      sum += std::abs(found[0] - mean.x) + std::abs(found[1] - mean.y) + std::abs(found[2] - mean.z);
    }
  }
  EXPECT_LT(sum / (3 * 40 * 40), 0.006);
}

TEST(AgainstOracle, RaysOfNoWeightChangeNothing) {
  const Scene scene{flat_glass()};
  Renderer renderer(scene, {}, device_of());
  RenderOptions options = exact_options(kSize, kSize);
  const Picture without = renderer.render(options);
  options.min_weight = 0;
  EXPECT_EQ(without.rgb, renderer.render(options).rgb);
}

TEST(AgainstOracle, TheDefaultCutOfWeightsIsInvisible) {
  const scene::Scene model = flat_glass();
  const Scene scene{scene::Scene(model)};
  RenderOptions options = exact_options(kSize, kSize, 8);
  options.min_weight = -1;  // the default: below half of an 8-bit step in the worst case
  Renderer renderer(scene, {}, device_of());
  expect_like(renderer.render(options), oracle::trace_picture(model, kSize, kSize, 8));
}

constexpr const char* kNff = R"(b 0.2 0.4 0.7
v
from 2.1 -4 2.2
at 0.05 0.1 0.3
up 0 0 1
angle 40
hither 0.5
resolution 128 128
l 4 -3 5
l -3 -4 6 0.4 0.3 0.2
f 0.9 0.8 0.5 0.7 0.3 12 0 0
p 5
-3 -3 -0.5
3 -3 -0.5
3 3 -0.5
0 0.5 -0.5
-3 3 -0.5
f 0.8 0.2 0.2 0.5 0.5 30 0 0
s 0.3 0.2 0.1 0.6
f 1 1 1 0 0.2 20 0.8 1.4
s -0.7 -0.6 0 0.45
f 0.2 0.7 0.3 0.8 0.2 5 0 0
c
-0.6 0.8 -0.5 0.4
-0.5 0.8 0.9 0.1
f 0.3 0.3 0.8 0.6 0.4 10 0 0
pp 3
1.2 -0.4 -0.5 0.5 -0.5 0.7
1.9 0.5 -0.5 0.7 0.2 0.6
1.3 0.1 1.1 -0.2 -0.3 0.9
)";

TEST(AgainstOracle, AnNffFileAllTheWay) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "kdray_against_oracle.nff";
  std::ofstream(file) << kNff;
  const Scene scene = Scene::load(file);
  std::filesystem::remove(file);
  ASSERT_EQ(scene.primitives(), 7u);
  ASSERT_EQ(scene.model().lights.size(), 2u);
  Renderer renderer(scene, {}, device_of());
  const RenderOptions options = exact_options(kSize, kSize);
  const oracle::OracleResult truth = oracle::trace_picture(scene.model(), kSize, kSize, options.depth);
  expect_like(renderer.render(options), truth);
  expect_same_rays(renderer, truth.counts);
}

// The scenes that come with kdray, as far as brute force reaches.
std::vector<std::string> shipped_scenes() {
  std::vector<std::string> names;
  const std::filesystem::path folder = source_path("scenes");
  if (!std::filesystem::is_directory(folder)) return names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class ShippedScenes : public testing::TestWithParam<std::string> {};

TEST_P(ShippedScenes, LookLikeTheOracles) {
  const Scene scene = Scene::load(source_path("scenes") / (GetParam() + ".json"));
  constexpr std::uint32_t kMost = 5000;
  if (scene.primitives() > kMost)
    GTEST_SKIP() << scene.primitives() << " primitives: too many for brute force";
  const auto& lights = scene.model().lights;
  if (std::any_of(lights.begin(), lights.end(), [](const auto& l) { return scene::has_area(l.kind); }))
    GTEST_SKIP() << "lit by samples, which the oracle doesn't take";
  expect_like_oracle(scene.model(), exact_options(kSize, kSize));
}

INSTANTIATE_TEST_SUITE_P(AgainstOracle, ShippedScenes, testing::ValuesIn(shipped_scenes()),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace_if(
                               name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); },
                               '_');
                           return name;
                         });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(ShippedScenes);

}  // namespace
}  // namespace kdray::test
