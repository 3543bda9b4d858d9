// What is told for certain of single primitives: by cases whose answers are plain.
#include "apps/verify/exact.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kdray::verify {
namespace {

using primitives::Quadratic;

const dvec3 kA(0, 0, 0), kB(1, 0, 0), kC(0, 1, 0);

TEST(ExactHits, ATriangleIsHitInsideOfItsMarginOnly) {
  const auto hit = [](double x, double y) { return sure_hit({{x, y, 2}, {0, 0, -0.5}}, kA, kB, kC, 0.01); };
  ASSERT_TRUE(hit(0.25, 0.25));
  EXPECT_DOUBLE_EQ(*hit(0.25, 0.25), 4);
  EXPECT_FALSE(hit(0.25, 0.005));
  EXPECT_FALSE(hit(0.25, -0.005));
  EXPECT_FALSE(hit(0.6, 0.6));
  EXPECT_TRUE(hit(0.25, 0.02));
  EXPECT_LT(*sure_hit({{0.25, 0.25, -2}, {0, 0, -1}}, kA, kB, kC, 0.01), 0);
}

TEST(ExactHits, ASphereFromOutsideAndInside) {
  const scene::SphereGeometry s{vec3(1, 0, 0), 2, 0};
  EXPECT_DOUBLE_EQ(*sure_hit({{-5, 0, 0}, {2, 0, 0}}, s, 0.1), 2);
  EXPECT_DOUBLE_EQ(*sure_hit({{1, 0, 0}, {0, 0, 4}}, s, 0.1), 0.5);
  EXPECT_FALSE(sure_hit({{-5, 1.95, 0}, {1, 0, 0}}, s, 0.1));
  EXPECT_GT(glm::dot(outward({-1, 0, 0}, s), dvec3(-1, 5, 0)), 0);
}

TEST(ExactHits, SidesOfAPlane) {
  EXPECT_EQ(side_of_plane({{9, 9, 1e-12}, {0, 0, -1}}, kA, kB, kC), 1);
  EXPECT_EQ(side_of_plane({{9, 9, 1e-12}, {0, 0, 1}}, kA, kB, kC), -1);
  EXPECT_EQ(side_of_plane({{9, 9, 0}, {0, 0, 1}}, kA, kB, kC), 0);
  EXPECT_EQ(side_of_plane({{9, 9, 1}, {1, 0, 0}}, kA, kB, kC), 0);
}

// The roots, and what a ray that has just left may not hit.
TEST(ExactHits, LeavingASphere) {
  const scene::SphereGeometry s{vec3(1, 0, 0), 2, 0};
  const Quadratic in = along({{-1 + 1e-6, 0, 0}, {0.5, 0, 0}}, s);
  EXPECT_FALSE(hits_again(in, 8, false));
  EXPECT_TRUE(hits_again(in, 1e-6, false));
  EXPECT_TRUE(hits_again(in, 1, true));  // it should have begun outside
  EXPECT_TRUE(hits_again(along({{-1 - 1e-6, 0, 0}, {-1, 1, 0}}, s), 1, true));
  EXPECT_FALSE(hits_again(along({{-1 - 1e-6, 0, 0}, {1, 0, 0}}, s), 1, true));
  EXPECT_TRUE(hits_again(along({{-1 - 1e-6, 0, 0}, {1, 0, 0}}, s), 1, false));
  // A ray that nearly runs along the surface, from a step inside of it, is out soon.
  const Quadratic grazing = along({{1, 2 - 1e-6, 0}, {1, 1e-6, 0}}, s);
  EXPECT_FALSE(hits_again(grazing, 2e-3, false));
}

TEST(ExactHits, ConesAndCylinders) {
  const scene::ConeGeometry cylinder{vec3(0), vec3(0, 0, 2), 1, 1, 0}, cone{vec3(0), vec3(0, 0, 1), 1, 0, 0};
  const Quadratic q = along({{-1, 0, 1}, {1, 0, 0.4}}, cylinder);
  EXPECT_NEAR(q.c, 0, 1e-15);
  EXPECT_NEAR(-2 * q.b / q.a, 2, 1e-12);
  const Quadratic p = along({{-0.5, 0, 0.5}, {1, 0, 0}}, cone);
  EXPECT_NEAR(-2 * p.b / p.a, 1, 1e-12);
  EXPECT_FALSE(hits_again(p, 1, false));
  EXPECT_TRUE(hits_again(p, 1e-5, false));
  EXPECT_GT(outward({0.5, 0, 0.5}, cone).z, 0);  // its side leans back
}

}  // namespace
}  // namespace kdray::verify
