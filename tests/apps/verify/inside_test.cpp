// Inside or outside, against solids whose insides are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "apps/verify/aims.h"
#include "apps/verify/exact.h"
#include "apps/verify/meshes.h"
#include "support/zero_area_meshes.h"

namespace kdray::verify {
namespace {

TEST(Inside, ACubeIsWhereItIs) {  // seed 1
  const Meshed m(Builder().cube({-1, -1, -1}, 2));
  const Insides insides(m.mesh, m.boxes, m.topology);
  Random random(1);
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const dvec3 p(random.between(-2, 2), random.between(-2, 2), random.between(-2, 2));
    const double depth = 1 - std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const Side side = insides.side_of(m.local(p), 0, m.local(1e-3));
    if (std::abs(depth) > 2e-3) {
      if (side == Side::unsure) continue;  // in the plane of a face, or in line with an edge
      EXPECT_EQ(side, depth > 0 ? Side::inside : Side::outside);
      inside += side == Side::inside;
    } else {
      EXPECT_NE(side, depth > 0 ? Side::outside : Side::inside);
    }
  }
  EXPECT_GT(inside, 2000);
}

TEST(Inside, NeverAGuessInLineWithEdgesAndCorners) {
  const Meshed m(Builder().cube({-1, -1, -1}, 2));
  const Insides insides(m.mesh, m.boxes, m.topology);
  for (const dvec3& p :
       {dvec3(0, 0, 0), dvec3(-3, 1, 0), dvec3(-3, 1, 1), dvec3(-3, 0.25, 0.25), dvec3(0.5, 1, 1)})
    EXPECT_NE(insides.side_of(m.local(p), 0, m.local(1e-6)),
              p == dvec3(0, 0, 0) ? Side::outside : Side::inside);
}

// A ball in a ball, each a component of its own; turned faces don't matter. (Seed 2.)
TEST(Inside, ComponentsAreToldApartAndTurnsDoNotMatter) {
  Builder b;
  b.ball({0, 0, 0}, 2, 24).ball({0.5, 0, 0}, 1, 12);
  for (std::size_t i = 0; i < b.scene().triangles.size(); i += 3) turn_over(b.scene().triangles[i]);
  const Meshed m(b);
  const Insides insides(m.mesh, m.boxes, m.topology);
  Random random(2);
  for (int i = 0; i < 5000; ++i) {
    const dvec3 p(random.between(-2.5, 2.5), random.between(-2.5, 2.5), random.between(-2.5, 2.5));
    const double far[2] = {glm::length(p) / 2, glm::length(p - dvec3(0.5, 0, 0))};
    for (std::uint32_t c = 0; c < 2; ++c) {
      const Side side = insides.side_of(m.local(p), c, m.local(1e-4));
      if (far[c] < 0.9) {
        EXPECT_NE(side, Side::outside);
      }
      if (far[c] > 1.01) {
        EXPECT_NE(side, Side::inside);
      }
    }
  }
}

// A box with many zero-area triangles is where the box is, but in the planes of its edges: they part nothing.
// (Seed 3.)
TEST(Inside, ZeroAreaDoesNotMatter) {
  test::LatticeMesh box = test::lattice_box(60);
  test::divide_edges(box, 40, 1);
  const Meshed m(test::scene_of(box));
  ASSERT_EQ(m.topology.components.size(), 1u);
  EXPECT_TRUE(m.topology.components[0].watertight);
  EXPECT_NEAR(m.volume(0), 120.0 * 240.0 * 360.0, 1);
  const Insides insides(m.mesh, m.boxes, m.topology);
  Random random(3);
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const dvec3 p(random.between(-90, 90), random.between(-180, 180), random.between(-270, 270));
    const double depth = std::min({60 - std::abs(p.x), 120 - std::abs(p.y), 180 - std::abs(p.z)});
    const Side side = insides.side_of(m.local(p), 0, m.local(1e-3));
    if (side == Side::unsure) continue;
    EXPECT_EQ(side, depth > 0 ? Side::inside : Side::outside);
    inside += side == Side::inside;
  }
  EXPECT_GT(inside, 5000);
}

}  // namespace
}  // namespace kdray::verify
