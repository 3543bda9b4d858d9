// What    A flock has as many instances as were asked for, as far apart, turned and mirrored; each stands
//         about its place, and the camera sees something.
#include "bench/workload/scenes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "scene/generate/displaced_sphere.h"

namespace kdray::bench {
namespace {

// With its middle off the origin, longest along y.
scene::Scene mesh() {
  scene::Scene s = generate::displaced_sphere(12);
  for (dvec3& v : s.vertices) v = v * dvec3(1, 2, 1) + dvec3(7, 8, 9);
  return s;
}

TEST(Flock, StandsInASquare) {
  const scene::Scene s = flock_of(mesh(), 4, 0.5);
  ASSERT_EQ(s.instances.size(), 16u);
  ASSERT_EQ(s.meshes.size(), 1u);
  EXPECT_TRUE(s.triangles.empty());
  EXPECT_TRUE(s.camera.has_value());
  EXPECT_FALSE(s.lights.empty());
  const DBox box = s.meshes[0]->bounds();
  const dvec3 middle = (box.lo + box.hi) * 0.5;
  const double step = 0.5 * box.extent().y;
  for (int i = 0; i < 16; ++i) {
    const scene::Instance& instance = s.instances[static_cast<std::size_t>(i)];
    EXPECT_LT(glm::length(instance.point(middle) - dvec3(i % 4 * step, 0, i / 4 * step)), 1e-12) << i;
    EXPECT_NEAR(glm::determinant(instance.linear), i % 2 == 1 ? -1 : 1, 1e-12) << i;
    EXPECT_NEAR(instance.linear[1][1], 1, 1e-12) << "it stands upright";
    EXPECT_EQ(scene::fault_of(instance), nullptr);
    for (int k = 0; k < i; ++k)
      EXPECT_FALSE(instance.linear == s.instances[static_cast<std::size_t>(k)].linear);
  }
}

TEST(Flock, NeedsTriangles) {
  EXPECT_THROW(flock_of({}, 2, 1), Error);
}

}  // namespace
}  // namespace kdray::bench
