// What    The oracle's intersections against closed forms, and its grown and shrunk worlds.
#include "oracle/primitives.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "oracle/build_scene.h"

namespace kdray::oracle {
namespace {

const scene::Material kAny = matte(vec3(1));

TEST(Primitives, SphereFromOutsideInsideAndBeside) {
  const SceneBuilder b = SceneBuilder().sphere({1, 2, 3}, 2, kAny);
  const World world(b.scene());
  EXPECT_DOUBLE_EQ(world.closest({{1, 2, 10}, {0, 0, -1}}).t, 5);
  EXPECT_DOUBLE_EQ(world.closest({{1, 2, 10}, {0, 0, -10}}).t, 0.5);  // t counts in directions
  EXPECT_DOUBLE_EQ(world.closest({{1, 2, 3}, {0, 1, 0}}).t, 2);
  EXPECT_FALSE(world.closest({{1, 2, 10}, {0, 0, 1}}).found());
  EXPECT_FALSE(world.closest({{3.0001, 2, 10}, {0, 0, -1}}).found());
  EXPECT_TRUE(world.closest({{2.9999, 2, 10}, {0, 0, -1}}).found());
}

TEST(Primitives, TheIntervalIsHonoured) {
  const SceneBuilder b = SceneBuilder().sphere({0, 0, 0}, 1, kAny);
  const World world(b.scene());
  const dvec3 from{0, 0, 5}, way{0, 0, -1};
  EXPECT_DOUBLE_EQ(world.closest({from, way, 4.5, 100}).t, 6);  // the far side
  EXPECT_FALSE(world.closest({from, way, 0, 3.9}).found());
  EXPECT_FALSE(world.closest({from, way, 6.1, 100}).found());
  EXPECT_TRUE(world.occluded({from, way, 0, 4.1}));
  EXPECT_FALSE(world.occluded({from, way, 0, 4}));  // strictly between
}

TEST(Primitives, ARayFromASurfaceMeetsItsFarSideOnly) {
  const SceneBuilder b =
      SceneBuilder().sphere({0, 0, 0}, 1, kAny).triangle({-9, 2, 9}, {9, 2, 9}, {0, 2, -9}, kAny);
  const World world(b.scene());
  const dvec3 start = glm::normalize(dvec3(0.3, 0.5, -0.2));
  EXPECT_FALSE(world.closest({start, -dvec3(0, 1, 0) + 2.0 * start, 1e-9, 100, 0}).primitive == 0);
  const Hit through = world.closest({start, -start, 1e-9, 100, 0});
  EXPECT_EQ(through.primitive, 0);
  EXPECT_NEAR(through.t, 2, 1e-14);
  EXPECT_FALSE(world.closest({{0, 2, 0}, {0, 1, 0}, 0, 100, 1}).found());
}

TEST(Primitives, TriangleWeightsAndTies) {
  const SceneBuilder b = SceneBuilder()
                             .triangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0}, kAny)
                             .triangle({0, 0, 0}, {0, 4, 0}, {4, 0, 0}, kAny);
  const World world(b.scene());
  const Hit hit = world.closest({{1, 2, 3}, {0, 0, -1}});
  EXPECT_EQ(hit.primitive, 0);  // the same place twice: the smaller number
  EXPECT_DOUBLE_EQ(hit.t, 3);
  EXPECT_DOUBLE_EQ(hit.u, 0.25);
  EXPECT_DOUBLE_EQ(hit.v, 0.5);
  EXPECT_FALSE(world.closest({{3, 2, 3}, {0, 0, -1}}).found());
  EXPECT_FALSE(world.closest({{1, 1, 0}, {1, 0, 0}}).found());  // in its plane: no area to hit
}

TEST(Primitives, TheFrontOfATriangleIsCounterClockwise) {
  const SceneBuilder b = SceneBuilder().triangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0}, kAny);
  const World world(b.scene());
  const Ray ray{{1, 1, -3}, {0, 0, 1}};
  EXPECT_EQ(world.surface(ray, world.closest(ray)).outward, dvec3(0, 0, 1));
}

TEST(Primitives, ConeOnTheSlopeAlongTheAxisAndPastItsEnds) {
  // Radius 2 at height 0, 0 at height 4.
  const SceneBuilder b = SceneBuilder().cone({0, 0, 0}, 2, {0, 4, 0}, 0, kAny);
  const World world(b.scene());
  const Ray side{{10, 1, 0}, {-1, 0, 0}};
  const Hit hit = world.closest(side);
  EXPECT_NEAR(hit.t, 10 - 1.5, 1e-14);
  EXPECT_NEAR(hit.u, 0.25, 1e-14);
  const dvec3 normal = world.surface(side, hit).outward;
  EXPECT_NEAR(glm::length(normal - glm::normalize(dvec3(4, 2, 0))), 0, 1e-14);
  EXPECT_FALSE(world.closest({{10, -0.01, 0}, {-1, 0, 0}}).found());
  EXPECT_FALSE(world.closest({{10, 4.5, 0}, {-1, 0, 0}}).found());  // the mirrored half beyond the point
  const Hit open = world.closest({{1, -5, 0}, {0, 1, 0}});          // in through the open base
  EXPECT_NEAR(open.t, 7, 1e-14);
}

TEST(Primitives, CylinderAndParallelRays) {
  const SceneBuilder b =
      SceneBuilder().cone({0, 0, 0}, 1, {0, 0, 3}, 1, kAny).cone({5, 0, 0}, 1, {5, 0, 1}, 0, kAny);
  const World world(b.scene());
  EXPECT_NEAR(world.closest({{4, 0, 2}, {-1, 0, 0}}).t, 3, 1e-14);
  EXPECT_FALSE(world.closest({{0.5, 0, -1}, {0, 0, 1}}).found());
  // Parallel to the cone's slope the square term vanishes: one hit, on the far side.
  const Hit hit = world.closest({{5.5, 0, 0}, {-1, 0, 1}});
  EXPECT_EQ(hit.primitive, 1);
  EXPECT_NEAR(hit.t, 0.75, 1e-14);
}

// Points sampled on each surface must be hit, at the distance they were sampled at.
TEST(Primitives, SampledSurfacePointsAreHit) {
  const unsigned seed = 20091;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return dvec3(uniform(random), uniform(random), uniform(random)); };
  for (int i = 0; i < 2000; ++i) {
    const dvec3 base = vector(), apex = vector(), eye = 20.0 * vector();
    const double r0 = 0.1 + std::abs(uniform(random)), r1 = std::abs(uniform(random)),
                 u = 0.5 + 0.5 * uniform(random);
    const dvec3 axis = glm::normalize(apex - base);
    const dvec3 across = glm::normalize(glm::cross(axis, vector()));
    const SceneBuilder b = SceneBuilder().cone(base, r0, apex, r1, kAny).sphere(base, r0, kAny);
    const World world(b.scene());
    const double near = 1e-6;
    const dvec3 on_cone = glm::mix(base, apex, u) + across * std::lerp(r0, r1, u);
    const Hit cone = world.closest({eye, on_cone - eye, 1 - near, 1 + near, 1});
    ASSERT_TRUE(cone.found()) << i;
    EXPECT_NEAR(cone.t, 1, 1e-7);
    const dvec3 on_sphere = base + r0 * glm::normalize(vector());
    EXPECT_TRUE(world.closest({eye, on_sphere - eye, 1 - near, 1 + near}, 1e-12).found()) << i;
  }
}

TEST(Primitives, GrownAndShrunkWorldsBracketTheEdge) {
  const SceneBuilder b = SceneBuilder()
                             .triangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0}, kAny)
                             .sphere({20, 0, 0}, 1, kAny)
                             .cone({40, 0, 0}, 1, {40, 4, 0}, 1, kAny);
  const World world(b.scene());
  const double e = 1e-3;
  const dvec3 inside[] = {{1, 0.5 * e, 9}, {21 - 0.5 * e, 0, 9}, {41 - 0.5 * e, 1, 9}, {40, 0.5 * e, 9}};
  const dvec3 outside[] = {{1, -0.5 * e, 9}, {21 + 0.5 * e, 0, 9}, {41 + 0.5 * e, 1, 9}, {40, -0.5 * e, 9}};
  for (const dvec3& p : inside) {
    EXPECT_TRUE(world.closest({p, {0, 0, -1}}).found()) << p.x;
    EXPECT_FALSE(world.closest({p, {0, 0, -1}}, -e).found()) << p.x;
  }
  for (const dvec3& p : outside) {
    EXPECT_FALSE(world.closest({p, {0, 0, -1}}).found()) << p.x;
    EXPECT_TRUE(world.closest({p, {0, 0, -1}}, e).found()) << p.x;
  }
}

}  // namespace
}  // namespace kdray::oracle
