// What    Lives of rays in scenes whose every ray is known: a mirror, a lit floor, a pane of glass. Hits are
//         computed by the test, from the scene's one plane.
#include "bench/modes/lives.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kdray::bench {
namespace {

// A square in the plane z = 0, seen from above, wider than the picture.
scene::Scene square() {
  scene::Scene s;
  s.vertices = {dvec3(-9, -9, 0), dvec3(9, -9, 0), dvec3(9, 9, 0), dvec3(-9, 9, 0)};
  s.triangles.push_back({{0, 1, 2}});
  s.triangles.push_back({{0, 2, 3}});
  s.triangles[1].number = 1;
  s.materials.emplace_back();
  s.camera = scene::Camera{dvec3(0, 0, 4), dvec3(0), dvec3(0, 1, 0), 0.5, 0};
  return s;
}

std::vector<Hit> trace_plane(std::span<const Ray> rays) {
  std::vector<Hit> hits;
  for (const Ray& ray : rays) {
    const float t = -ray.origin[2] / ray.direction[2];
    const bool hit = t > ray.t_min && t < ray.t_max;
    hits.push_back({hit ? t : std::numeric_limits<float>::infinity(), hit ? 0 : -1, 0, 0});
  }
  return hits;
}

std::size_t count(const std::vector<LifeRay>& lives, LifeKind kind) {
  return static_cast<std::size_t>(
      std::count_if(lives.begin(), lives.end(), [&](const LifeRay& life) { return life.kind == kind; }));
}

TEST(Lives, EyeRaysEndAtWhatTheySee) {
  const std::vector<LifeRay> lives = make_lives(square(), {8, 4, 5, 0}, trace_plane);
  ASSERT_EQ(lives.size(), 32u);
  for (const LifeRay& life : lives) {
    EXPECT_EQ(life.parent, kNoParent);
    EXPECT_TRUE(life.hit);
    EXPECT_NEAR(life.ray.t_max * -life.ray.direction[2], 4, 1e-5);
  }
  EXPECT_LT(lives.front().ray.direction[0], 0);  // from the upper left
  EXPECT_GT(lives.front().ray.direction[1], 0);
  // Twice as wide as high.
  EXPECT_NEAR(lives.front().ray.direction[0] / lives.front().ray.direction[1], -(7.0 / 8) * 2 / (3.0 / 4),
              1e-5);
}

TEST(Lives, AMirrorSendsEachRayBack) {
  scene::Scene s = square();
  s.materials[0].reflect = vec3(0.5f);
  const std::vector<LifeRay> lives = make_lives(s, {4, 4, 3, 0}, trace_plane);
  EXPECT_EQ(count(lives, LifeKind::reflected), 16u);  // they leave, and there is no second time
  for (const LifeRay& life : lives) {
    if (life.kind != LifeKind::reflected) continue;
    EXPECT_EQ(life.depth, 2);
    EXPECT_FALSE(life.hit);
    EXPECT_EQ(life.ray.direction[2], -lives[life.parent].ray.direction[2]);
  }
}

TEST(Lives, DepthAndWeightEndThem) {
  scene::Scene s = square();
  s.materials[0].reflect = vec3(0.5f);
  EXPECT_EQ(make_lives(s, {4, 4, 1, 0}, trace_plane).size(), 16u);
  EXPECT_EQ(make_lives(s, {4, 4, 3, 0.6}, trace_plane).size(), 16u);
  EXPECT_EQ(make_lives(s, {4, 4, 3, 0.5}, trace_plane).size(), 32u);
}

TEST(Lives, LightsInFrontGetAShadowRayEach) {
  scene::Scene s = square();
  s.lights.resize(3);
  s.lights[0].position = dvec3(1, 1, 3);
  s.lights[1].position = dvec3(0, 0, -3);  // below the floor
  s.lights[2].kind = scene::LightKind::directional;
  const std::vector<LifeRay> lives = make_lives(s, {4, 4, 3, 0}, trace_plane);
  EXPECT_EQ(count(lives, LifeKind::shadow), 32u);
  for (const LifeRay& life : lives) {
    if (life.kind != LifeKind::shadow) continue;
    EXPECT_FALSE(life.hit);
    EXPECT_EQ(life.depth, 1);
    EXPECT_EQ(lives[life.parent].kind, LifeKind::primary);
  }
}

TEST(Lives, GlassLetsThemThrough) {
  scene::Scene s = square();
  s.materials[0].transmit = vec3(0.5f);
  s.materials[0].index = 1.5f;
  const std::vector<LifeRay> lives = make_lives(s, {4, 4, 3, 0}, trace_plane);
  EXPECT_EQ(count(lives, LifeKind::refracted), 16u);
  for (const LifeRay& life : lives) {
    if (life.kind != LifeKind::refracted) continue;
    const Ray &from = lives[life.parent].ray, &to = life.ray;
    EXPECT_LT(to.direction[2], 0);
    EXPECT_NEAR(std::hypot(to.direction[0], to.direction[1]),
                std::hypot(from.direction[0], from.direction[1]) / 1.5, 1e-6);  // Snell
  }
}

}  // namespace
}  // namespace kdray::bench
