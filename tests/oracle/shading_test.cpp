// What    The oracle's shading against closed forms: each term of the model alone.
#include <gtest/gtest.h>

#include <cmath>

#include "oracle/build_scene.h"
#include "oracle/oracle.h"

namespace kdray::oracle {
namespace {

struct Traced {
  dvec3 color;
  Path path;
  RayCounts counts;
};

Traced trace(const SceneBuilder& b, const dvec3& origin, const dvec3& direction, int depth = 5) {
  Traced out;
  Ray ray;
  ray.origin = origin;
  ray.direction = glm::normalize(direction);
  out.color = Whitted(b.scene(), depth).trace_eye(ray, out.path, out.counts);
  return out;
}

void expect_color(const dvec3& found, const dvec3& wanted, double tolerance = 1e-12) {
  EXPECT_NEAR(found.x, wanted.x, tolerance);
  EXPECT_NEAR(found.y, wanted.y, tolerance);
  EXPECT_NEAR(found.z, wanted.z, tolerance);
}

TEST(Shading, EveryTermOfALitSphere) {
  scene::Material m = matte({0.5f, 0.25f, 0.125f});
  m.emission = {0.0625f, 0, 0};
  m.ambient = {0.25f, 0.5f, 1};
  m.specular = vec3(0.5f);
  m.shine = 3;
  const SceneBuilder b =
      SceneBuilder().sphere({0, 0, 0}, 1, m).ambient({0.5f, 0.25f, 0}).light({0, 4, 4}, {1, 0.5f, 0.25f});
  const Traced t = trace(b, {0, 0, 9}, {0, 0, -1});
  const double cosine = 3 / 5.0;  // the light from (0, 0, 1) is at (0, 4, 3): R.V is the same
  const double highlight = 0.5 * cosine * cosine * cosine;
  expect_color(t.color, {0.0625 + 0.125 + 0.5 * cosine + highlight, 0.125 + 0.5 * (0.25 * cosine + highlight),
                         0.25 * (0.125 * cosine + highlight)});
  EXPECT_EQ(t.counts.shadow, 1u);
  EXPECT_EQ(t.counts.primary_hit, 1u);
}

TEST(Shading, BothSidesAreLitAlike) {
  const SceneBuilder b = SceneBuilder()
                             .triangle({-9, -9, 0}, {9, -9, 0}, {0, 9, 0}, matte(vec3(1)))
                             .light({0, 0, 5}, {1, 0, 0})
                             .light({0, 0, -5}, {0, 1, 0});
  expect_color(trace(b, {0, 0, 2}, {0, 0, -1}).color, {1, 0, 0});
  expect_color(trace(b, {0, 0, -2}, {0, 0, 1}).color, {0, 1, 0});
}

TEST(Shading, TransparentAndOpaqueBlockersShadow) {
  SceneBuilder b = SceneBuilder().quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, matte(vec3(1))).light({0, 5, 0});
  expect_color(trace(b, {0, 3, 0}, {0, -1, 0}).color, dvec3(1));
  b.sphere({0, 4, 0}, 0.5, glass(1.5f));
  expect_color(trace(b, {0, 3, 0}, {0, -1, 0}).color, dvec3(0));
  EXPECT_GT(trace(b, {0, 3, 0}, {1, -1, 0}).color.x, 0.1);
}

TEST(Shading, ABlockerBehindTheLightDoesNotShadow) {
  const SceneBuilder b = SceneBuilder()
                             .quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, matte(vec3(1)))
                             .light({0, 5, 0})
                             .sphere({0, 7, 0}, 1, matte(vec3(1)));
  expect_color(trace(b, {0, 3, 0}, {0, -1, 0}).color, dvec3(1));
}

TEST(Shading, AttenuationAndRange) {
  scene::Light l;
  l.position = {0, 4, 0};
  l.attenuation = {1, 0.5f, 0.25f};
  SceneBuilder b = SceneBuilder().quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, matte(vec3(1))).light(l);
  expect_color(trace(b, {0, 3, 0}, {0, -1, 0}).color, dvec3(1.0 / (1 + 2 + 4)));
  l.range = 3.99;
  SceneBuilder short_of = SceneBuilder().quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, matte(vec3(1))).light(l);
  const Traced t = trace(short_of, {0, 3, 0}, {0, -1, 0});
  expect_color(t.color, dvec3(0));
  EXPECT_EQ(t.counts.shadow, 0u);
}

TEST(Shading, DirectionalLightHasNoDistance) {
  scene::Light l;
  l.kind = scene::LightKind::directional;
  l.direction = glm::normalize(dvec3(3, -4, 0));
  l.attenuation = {0, 0, 1};
  SceneBuilder b = SceneBuilder().quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, matte(vec3(1))).light(l);
  expect_color(trace(b, {0, 3, 0}, {0, -1, 0}).color, dvec3(0.8));
  b.sphere({-30, 40, 0}, 1, matte(vec3(1)));  // far up the light's way
  expect_color(trace(b, {0, 3, 0}, {0, -1, 0}).color, dvec3(0));
}

TEST(Shading, SpotFactorIsSquaredBetweenTheCones) {
  scene::Light l;
  l.kind = scene::LightKind::spot;
  l.position = {0, 1, 0};
  l.direction = {0, -1, 0};
  l.cos_inner = 0.75f;
  l.cos_outer = 0.5f;
  const SceneBuilder b = SceneBuilder().quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, matte(vec3(1))).light(l);
  const auto at = [&](double cosine) {  // seen straight down, at the point under that angle
    return trace(b, {std::sqrt(1 / (cosine * cosine) - 1), 0.5, 0}, {0, -1, 0}).color.x / cosine;
  };
  EXPECT_NEAR(at(0.9), 1, 1e-12);
  EXPECT_NEAR(at(0.625), 0.25, 1e-12);
  EXPECT_NEAR(at(0.5625), 0.0625, 1e-12);
  EXPECT_EQ(at(0.49), 0);
}

TEST(Shading, AMirrorShowsWhatIsBehindTheViewer) {
  const SceneBuilder b = SceneBuilder()
                             .quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, mirror({0.5f, 0.25f, 1}))
                             .background({0.5f, 1, 0.25f});
  const Traced t = trace(b, {0, 0, 3}, {0.1, 0.2, -1});
  expect_color(t.color, {0.25, 0.25, 0.25});
  EXPECT_EQ(t.counts.reflected, 1u);
  EXPECT_EQ(t.path, (Path{1, kNothing}));
}

TEST(Shading, DepthEndsAHallOfMirrors) {
  SceneBuilder b;
  scene::Material m = mirror(vec3(0.5f));
  m.emission = vec3(1);
  b.quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, m).quad({-9, -9, 4}, {18, 0, 0}, {0, 18, 0}, m);
  const Traced t = trace(b, {0, 0.01, 2}, {0, 0, -1}, 4);
  expect_color(t.color, dvec3(1 + 0.5 + 0.25 + 0.125));
  EXPECT_EQ(t.counts.reflected, 3u);
}

// A slab of glass displaces a ray by d*sin(a - b)/cos(b) and leaves its direction alone.
TEST(Shading, AGlassSlabDisplacesTheRay) {
  const double index = 1.5, thickness = 1, angle = 0.6;
  const double inside = std::asin(std::sin(angle) / index);
  const double landing = thickness * std::tan(inside) + 2 * std::tan(angle);  // 2 below the slab
  for (const double aside : {-1e-3, 1e-3}) {
    SceneBuilder b = SceneBuilder()
                         .quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, glass(1.5f))
                         .quad({-9, -thickness, 9}, {0, 0, -18}, {18, 0, 0}, glass(1.5f));
    b.quad({landing + aside, -3, 9}, {18, 0, 0}, {0, 0, -18}, glowing(vec3(1)));  // begins at the landing
    const Traced t = trace(b, {-std::tan(angle), 1, 0}, {std::sin(angle), -std::cos(angle), 0});
    EXPECT_EQ(t.color.x, aside < 0 ? 1 : 0);
    EXPECT_EQ(t.counts.refracted, 2u);
  }
}

TEST(Shading, IndexOnePassesStraightThrough) {
  const SceneBuilder b = SceneBuilder()
                             .sphere({0, 0, 0}, 1, glass(1, vec3(0.5f)))
                             .quad({-9, -9, -5}, {18, 0, 0}, {0, 18, 0}, glowing(vec3(1)));
  expect_color(trace(b, {0.7, 0.3, 5}, {0, 0, -1}).color, dvec3(0.25));
}

TEST(Shading, TotalReflectionTakesTheRefractedShare) {
  // From inside glass, below a horizontal face, at 60 degrees: sin(60) * 1.5 > 1.
  const SceneBuilder b = SceneBuilder()
                             .quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, glass(1.5f, vec3(0.5f), vec3(0.25f)))
                             .background({1, 0.5f, 0});
  const Traced total = trace(b, {0, -1, 0}, {std::sin(1.0472), std::cos(1.0472), 0});
  expect_color(total.color, {0.75, 0.375, 0});
  EXPECT_EQ(total.counts.reflected, 1u);
  EXPECT_EQ(total.counts.refracted, 0u);
  const Traced split = trace(b, {0, -1, 0}, {std::sin(0.5), std::cos(0.5), 0});
  EXPECT_EQ(split.counts.reflected, 1u);
  EXPECT_EQ(split.counts.refracted, 1u);
  const Traced entering = trace(b, {0, 1, 0}, {std::sin(1.0472), -std::cos(1.0472), 0});
  EXPECT_EQ(entering.counts.refracted, 1u);
}

// A triangle whose vertex normals lean outward, as on a coarse sphere, and a light low over its plane.
class Terminator : public testing::Test {
 protected:
  static SceneBuilder bulge(double light_height) {
    SceneBuilder b;
    b.smooth({-1, 0, 1}, {1, 0, 1}, {0, 0, -1}, {-1, 2, 1}, {1, 2, 1}, {0, 2, -1}, matte(vec3(1)));
    return b.light({8, light_height, 0});
  }
};

TEST_F(Terminator, AWallTooLowForTheBulgeDoesNotShadow) {
  // The bulge at the triangle's middle lifts the start of the shadow ray; a wall lower than that must not
  // block it.
  SceneBuilder b = bulge(1);
  const dvec3 middle{0, 0, 0};
  double lift = 0;
  const dvec3 corner[3] = {{-1, 0, 1}, {1, 0, 1}, {0, 0, -1}};
  const dvec3 normal[3] = {{-1, 2, 1}, {1, 2, 1}, {0, 2, -1}};
  const double weight[3] = {0.25, 0.25, 0.5};
  for (int i = 0; i < 3; ++i) {
    const dvec3 n = glm::normalize(normal[i]);
    lift -= weight[i] * std::min(0.0, glm::dot(middle - corner[i], n)) * n.y;
  }
  ASSERT_GT(lift, 0.1);
  // Just under and just over the line from the lifted point (x = 0 by symmetry) to the light.
  const double wall = std::lerp(lift, 1.0, 0.5 / 8);
  for (const double height : {wall - 1e-3, wall + 1e-3}) {
    SceneBuilder walled = b;
    walled.quad({0.5, -1, 1}, {0, 0, -2}, {0, 1 + height, 0}, matte(vec3(1)));
    EXPECT_EQ(trace(walled, {0, 3, 0}, {0, -1, 0}).color.x > 0, height < wall) << height;
  }
}

TEST_F(Terminator, ALightUnderThePlaneStillReachesTheBulge) {
  // Near the right corner the shading normal leans by 45 degrees: a light below the plane is in front of it.
  const Traced t = trace(bulge(-0.5), {0.9, 3, 0.95}, {0, -1, 0});
  EXPECT_GT(t.color.x, 0.1);
  // A flat triangle is not.
  SceneBuilder flat;
  flat.triangle({-1, 0, 1}, {1, 0, 1}, {0, 0, -1}, matte(vec3(1))).light({8, -0.5, 0});
  EXPECT_EQ(trace(flat, {0.9, 3, 0.95}, {0, -1, 0}).color.x, 0);
}

TEST_F(Terminator, TheBackOfABulgeIsAHollow) {
  // From below all normals are turned over: the corners' tangent planes lie below the point nowhere, so no
  // lift.
  SceneBuilder b;
  b.smooth({-1, 0, 1}, {1, 0, 1}, {0, 0, -1}, {-1, 2, 1}, {1, 2, 1}, {0, 2, -1}, matte(vec3(1)));
  b.light({0, -4, 0}).quad({-5, -1e-3, 5}, {0, 0, -10}, {10, 0, 0}, matte(vec3(1)));
  EXPECT_EQ(trace(b, {0, -5e-4, 0}, {0, 1, 0}).color.x, 0);  // the thin sheet below blocks
}

TEST(Shading, AReflectionIntoTheSurfaceIsTurnedBack) {
  // A flat mirror whose vertex normals all lean far over: the reflected ray would go below it.
  SceneBuilder b;
  const vec3 lean{0.9f, 0.3f, 0};
  b.smooth({-9, 0, 9}, {9, 0, 9}, {0, 0, -9}, lean, lean, lean, mirror()).background({0, 0, 1});
  b.quad({-99, 5, 99}, {198, 0, 0}, {0, 0, -198}, glowing({1, 0, 0}));
  b.quad({-99, -5, 99}, {198, 0, 0}, {0, 0, -198}, glowing({0, 1, 0}));
  const dvec3 d = glm::normalize(dvec3(0.1, -1, 0)), n = glm::normalize(dvec3(lean));
  ASSERT_LT((d - 2 * glm::dot(d, n) * n).y, 0);
  expect_color(trace(b, {0, 3, 0}, d).color, {1, 0, 0});
}

}  // namespace
}  // namespace kdray::oracle
