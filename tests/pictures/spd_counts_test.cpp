// What    Ray counts of Haines' standard scenes against those published with them: the whole path from the
//         file to the spawned rays. 513x513 rays through pixel corners, depth 5, no cut by weight.
// Source  E. Haines, Standard Procedural Databases, version 3, README (timings section).
#include <gtest/gtest.h>

#include "pictures/render.h"
#include "support/data.h"

namespace kdray::test {
namespace {

struct Published {
  const char* name;
  double hits, shadow, reflected, refracted;
  double refracted_within = 0.01;
};

void PrintTo(const Published& p, std::ostream* out) {
  *out << p.name;
}

class SpdCounts : public testing::TestWithParam<Published> {};

TEST_P(SpdCounts, AreThePublishedOnes) {
  const Published& wanted = GetParam();
  const std::filesystem::path file = data_path(std::string("spd/") + wanted.name + ".nff.gz");
  KDRAY_NEED_DATA(file);
  const Scene scene = Scene::load(file);
  Renderer renderer(scene, {}, device_of());
  RenderOptions options = exact_options(513, 513);
  options.grid = PixelGrid::corners;
  options.min_weight = 0;  // the published counts hold the rays of no weight, too
  renderer.render(options);
  const nlohmann::json rays = statistics_of(renderer).at("rays");
  const auto expect_within = [&](const char* kind, double published, double share) {
    EXPECT_NEAR(rays.at(kind).get<double>(), published, share * published) << kind;
  };
  EXPECT_EQ(rays.at("primary").get<int>(), 513 * 513);
  expect_within("primary_hit", wanted.hits, 0.01);
  expect_within("shadow", wanted.shadow, 0.01);
  expect_within("reflected", wanted.reflected, 0.01);
  expect_within("refracted", wanted.refracted, wanted.refracted_within);
}

// Published programs differ among themselves on gears' refraction: its gears touch, and which of two
// coinciding faces a ray meets first is theirs to choose.
INSTANTIATE_TEST_SUITE_P(Published, SpdCounts,
                         testing::Values(Published{"balls", 263169, 954368, 175095, 0},
                                         Published{"gears", 245086, 2246955, 304643, 207564, 0.04},
                                         Published{"mount", 173125, 412922, 354769, 354769},
                                         Published{"rings", 263169, 1085002, 315236, 0},
                                         Published{"teapot", 161120, 407656, 225248, 0},
                                         Published{"tetra", 49788, 46112, 0, 0},
                                         Published{"tree", 169836, 1097419, 0, 0}),
                         [](const auto& info) { return std::string(info.param.name); });

class SpdFiles : public testing::TestWithParam<const char*> {};

TEST_P(SpdFiles, Render) {
  const std::filesystem::path file = data_path(std::string("spd/") + GetParam() + ".nff.gz");
  KDRAY_NEED_DATA(file);
  const Scene scene = Scene::load(file);
  Renderer renderer(scene, {}, device_of());
  RenderOptions options = exact_options(96, 96);
  options.channels = {"primitive"};
  const Picture picture = renderer.render(options);
  ASSERT_EQ(picture.rgb.size(), 3u * 96 * 96);
  EXPECT_TRUE(all_finite(picture));
  int hits = 0;
  float brightest = 0, darkest = 1e9f;
  for (const float p : channel(picture, "primitive")) hits += p >= 0;
  for (const float v : picture.rgb) brightest = std::max(brightest, v), darkest = std::min(darkest, v);
  EXPECT_GT(hits, 96 * 96 / 20);
  EXPECT_GT(brightest, 0.2f);
  EXPECT_GE(darkest, 0.0f);
  EXPECT_LT(darkest, brightest);
}

INSTANTIATE_TEST_SUITE_P(All, SpdFiles,
                         testing::Values("balls", "gears", "jacks", "lattice", "mount", "nurbtst", "rings",
                                         "sample", "shells", "sombrero", "teapot", "tetra", "tree"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace kdray::test
