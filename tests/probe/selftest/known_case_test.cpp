// What    The self-test's answers against closed forms in double: the table itself must be right.
#include "probe/selftest/self_test.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <set>

#include "probe/selftest/self_test.h"

namespace kdray::selftest {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Found {
  double t = kInfinity;
  int primitive = -1;
};

void nearer(Found& best, double t, int primitive) {
  if (t > 0 && t < best.t) best = {t, primitive};
}

void hit_triangle(const scene::Scene& scene, std::size_t i, const dvec3& o, const dvec3& d, Found& best) {
  const auto corner = [&](int k) { return dvec3(scene.vertices[scene.triangles[i].vertex[k]]); };
  const dvec3 e1 = corner(1) - corner(0), e2 = corner(2) - corner(0), p = glm::cross(d, e2),
              s = o - corner(0);
  const double det = glm::dot(e1, p);
  const double u = glm::dot(s, p) / det, v = glm::dot(d, glm::cross(s, e1)) / det;
  if (u >= 0 && v >= 0 && u + v <= 1)
    nearer(best, glm::dot(e2, glm::cross(s, e1)) / det, static_cast<int>(scene.triangles[i].number));
}

// Visits both roots of a*t^2 + 2*b*t + c.
template <class Visit>
void for_each_root(double a, double b, double c, const Visit& visit) {
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return;
  visit((-b - std::sqrt(discriminant)) / a);
  visit((-b + std::sqrt(discriminant)) / a);
}

void hit_sphere(const scene::Sphere& sphere, const dvec3& o, const dvec3& d, Found& best) {
  const dvec3 f = o - sphere.center;
  for_each_root(glm::dot(d, d), glm::dot(d, f), glm::dot(f, f) - sphere.radius * sphere.radius,
                [&](double t) { nearer(best, t, static_cast<int>(sphere.number)); });
}

// The distance from the axis is base + slope * height, heights from 0 to the axis' length.
void hit_cone(const scene::Cone& cone, const dvec3& o, const dvec3& d, Found& best) {
  const double length = glm::length(cone.apex - cone.base);
  const dvec3 axis = (cone.apex - cone.base) / length, f = o - cone.base;
  const double slope = (cone.apex_radius - cone.base_radius) / length;
  const double dh = glm::dot(d, axis), fh = glm::dot(f, axis), r = cone.base_radius + slope * fh;
  for_each_root(glm::dot(d, d) - dh * dh * (1 + slope * slope), glm::dot(f, d) - fh * dh - r * slope * dh,
                glm::dot(f, f) - fh * fh - r * r, [&](double t) {
                  const double height = fh + t * dh;
                  if (height >= 0 && height <= length) nearer(best, t, static_cast<int>(cone.number));
                });
}

TEST(KnownCase, TheAnswersAreThoseOfClosedForms) {
  const scene::Scene scene = known_scene();
  const std::vector<Ray> rays = known_rays();
  std::set<int> seen;
  ASSERT_EQ(rays.size(), known_answers().size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const dvec3 o(rays[i].origin[0], rays[i].origin[1], rays[i].origin[2]);
    const dvec3 d(rays[i].direction[0], rays[i].direction[1], rays[i].direction[2]);
    Found best;
    for (std::size_t k = 0; k < scene.triangles.size(); ++k) hit_triangle(scene, k, o, d, best);
    hit_sphere(scene.spheres.front(), o, d, best);
    hit_cone(scene.cones.front(), o, d, best);
    const Answer& answer = known_answers()[i];
    EXPECT_EQ(answer.primitive, best.primitive) << "ray " << i;
    const double t = std::bit_cast<float>(answer.t);
    if (best.primitive < 0) {
      EXPECT_TRUE(std::isinf(t)) << "ray " << i;
    } else {
      EXPECT_NEAR(t, best.t, 2e-6 * best.t) << "ray " << i;
    }
    seen.insert(best.primitive);
  }
  EXPECT_EQ(seen, (std::set<int>{-1, 0, 1, 2, 3})) << "every kind, and misses";
}

TEST(KnownCase, EveryBitOfEveryHitIsCompared) {
  std::vector<Hit> hits;
  for (const Answer& a : known_answers())
    hits.push_back(
        {std::bit_cast<float>(a.t), a.primitive, std::bit_cast<float>(a.u), std::bit_cast<float>(a.v)});
  EXPECT_EQ(first_fault(hits, true), "");
  for (std::size_t i = 0; i < hits.size(); ++i) {
    for (float* const value : {&hits[i].t, &hits[i].u, &hits[i].v}) {
      const float right = *value;
      *value = std::bit_cast<float>(std::bit_cast<std::uint32_t>(right) ^ 1u);
      EXPECT_NE(first_fault(hits, true), "") << "ray " << i;
      if (std::isfinite(right)) {
        EXPECT_EQ(first_fault(hits, false), "") << "ray " << i;
        *value = right + 0.001f;
        EXPECT_NE(first_fault(hits, false), "") << "ray " << i;
      }
      *value = right;
    }
    hits[i].primitive += 1;
    EXPECT_NE(first_fault(hits, true), "") << "ray " << i;
    EXPECT_NE(first_fault(hits, false), "") << "ray " << i;
    hits[i].primitive -= 1;
  }
  hits.pop_back();
  EXPECT_NE(first_fault(hits, true), "");
}

}  // namespace
}  // namespace kdray::selftest
