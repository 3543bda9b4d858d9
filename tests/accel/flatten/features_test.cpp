// The mask names what a scene needs and nothing else.
#include "accel/flatten/features.h"

#include <gtest/gtest.h>

#include <set>

#include "layout/features.h"

namespace kdray::flatten {
namespace {

scene::Scene triangle_scene() {
  scene::Scene s;
  s.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  s.triangles = {{.vertex = {0, 1, 2}}};
  s.materials = {scene::Material{.diffuse = vec3(0.5f)}};
  return s;
}

layout::Features mask_of(const scene::Scene& s) {
  return features_of(s, scene::make_geometry(s));
}

TEST(Features, AnEmptySceneNeedsNothing) {
  EXPECT_EQ(mask_of(scene::Scene{}), 0u);
}

TEST(Features, ALitDiffuseTriangle) {
  scene::Scene s = triangle_scene();
  EXPECT_EQ(mask_of(s), KDRAY_FEATURE_KIND(TRIANGLE) | KDRAY_FEATURE_DIFFUSE);
  s.lights.emplace_back();
  EXPECT_EQ(mask_of(s), KDRAY_FEATURE_KIND(TRIANGLE) | KDRAY_FEATURE_DIFFUSE | KDRAY_FEATURE_LIGHTS);
}

TEST(Features, AMaterialThatNobodyWearsDoesNotCount) {
  scene::Scene s = triangle_scene();
  s.materials.push_back({.reflect = vec3(1), .transmit = vec3(1)});
  EXPECT_EQ(mask_of(s) & (KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT), 0u);
  s.triangles[0].material = 1;
  EXPECT_EQ(mask_of(s) & (KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT),
            KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT);
}

TEST(Features, LightsThatCanChangeNothingAreLeftOut) {
  scene::Scene s = triangle_scene();
  s.materials[0] = {.emission = vec3(1)};
  s.lights.emplace_back();
  EXPECT_EQ(mask_of(s) & KDRAY_FEATURE_LIGHTS, 0u);
}

TEST(Features, EachKindOfLight) {
  scene::Scene s = triangle_scene();
  s.lights = {scene::Light{.kind = scene::LightKind::directional},
              scene::Light{.kind = scene::LightKind::spot}, scene::Light{.attenuation = vec3(0, 0, 1)}};
  const layout::Features wanted = KDRAY_FEATURE_DIRECTIONAL | KDRAY_FEATURE_SPOT | KDRAY_FEATURE_ATTENUATION;
  EXPECT_EQ(mask_of(s) & wanted, wanted);
}

TEST(Features, SmoothNormalsBackgroundAndSamples) {
  scene::Scene s = triangle_scene();
  s.normals = {{0, 0, 1}};
  s.triangles[0].normal = {0, 0, 0};
  s.background = vec3(0, 0, 0.1f);
  EXPECT_TRUE(mask_of(s) & KDRAY_FEATURE_SMOOTH);
  EXPECT_TRUE(mask_of(s) & KDRAY_FEATURE_BACKGROUND);
  EXPECT_EQ(features_of_samples(1), 0u);
  EXPECT_EQ(features_of_samples(4), KDRAY_FEATURE_SUPERSAMPLE);
}

TEST(Features, ZeroAreaAndSmoothNormalsAreApart) {
  scene::Scene s = triangle_scene();
  EXPECT_FALSE(mask_of(s) & KDRAY_FEATURE_ZERO_AREA);
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (const double x : {0, 1, 3}) s.vertices.push_back(dvec3(x, 0, 0));
  s.triangles.push_back({.vertex = {first, first + 1, first + 2}, .number = 1});
  EXPECT_TRUE(mask_of(s) & KDRAY_FEATURE_ZERO_AREA);
  EXPECT_FALSE(mask_of(s) & KDRAY_FEATURE_SMOOTH);
}

TEST(Features, NamesAreSplitWithoutLoss) {
  const FeatureNames some = feature_names(KDRAY_FEATURE_KIND(SPHERE) | KDRAY_FEATURE_LIGHTS);
  EXPECT_EQ((std::set<std::string>(some.on.begin(), some.on.end())),
            (std::set<std::string>{"spheres", "lights"}));
  EXPECT_EQ(some.on.size() + some.off.size(), feature_names(~Features{0}).on.size());
}

}  // namespace
}  // namespace kdray::flatten
