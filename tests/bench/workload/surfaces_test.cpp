// What    Normals of primitives, by number, against closed forms. (Of every kind, against the oracle:
//         tests/bench/kinds_test.cpp.)
#include "bench/workload/surfaces.h"

#include <gtest/gtest.h>

namespace kdray::bench {
namespace {

// The numbers are not in the order of the kinds.
scene::Scene three_kinds() {
  scene::Scene s;
  s.vertices = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  s.triangles.emplace_back().vertex = {0, 1, 2};
  s.triangles[0].number = 2;
  s.spheres.push_back({.center = {1, 2, 3}, .radius = 2, .number = 0});
  s.cones.push_back({.base = {0, 0, 0}, .apex = {0, 0, 2}, .base_radius = 3, .apex_radius = 1, .number = 1});
  return s;
}

void expect_near(const dvec3& found, const dvec3& wanted) {
  EXPECT_LT(glm::length(found - wanted), 1e-12) << found.x << " " << found.y << " " << found.z;
}

TEST(Surfaces, NormalsByNumber) {
  const scene::Scene s = three_kinds();
  const Surfaces surfaces(s);
  expect_near(surfaces.normal(2, {0.2, 0.2, 1}), {0, 0, 1});
  expect_near(surfaces.normal(0, {1, 4, 3}), {0, 1, 0});
  // A cone that narrows by 2 over a height of 2 leans back by 45 degrees.
  expect_near(surfaces.normal(1, {2, 0, 1}), glm::normalize(dvec3(1, 0, 1)));
  expect_near(surfaces.normal(1, {0, -2, 1}), glm::normalize(dvec3(0, -1, 1)));
}

}  // namespace
}  // namespace kdray::bench
