// Faces on each other: found where they are, and nowhere else; against all pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "apps/verify/meshes.h"
#include "support/zero_area_meshes.h"

namespace kdray::verify {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Duplicates duplicates_of(Builder& b) {
  const Meshed m(b);
  return find_duplicates(m.mesh, m.boxes);
}

TEST(Duplicates, ASoundMeshHasNone) {
  for (Builder& b :
       std::vector<Builder>{Builder().cube({0, 0, 0}, 1), Builder().ball({0, 0, 0}, 1, 32),
                            Builder().moebius(40), Builder().ball({0, 0, 0}, 1, 20).moved({1e6, 0, 0})}) {
    EXPECT_TRUE(duplicates_of(b).doubled.empty());
    EXPECT_TRUE(duplicates_of(b).overlapping.empty());
  }
}

TEST(Duplicates, TheSameFaceTwiceOrTurnedOver) {
  Builder b;
  b.cube({0, 0, 0}, 1);
  b.face({0, 0, 0}, {1, 1, 0}, {1, 0, 0});  // as face 1 starts at another corner
  const Duplicates same = duplicates_of(b);
  EXPECT_EQ(same.doubled, std::vector<std::uint32_t>{12});
  EXPECT_TRUE(same.overlapping.empty());
  turn_over(b.scene().triangles.back());
  EXPECT_EQ(duplicates_of(b).doubled, std::vector<std::uint32_t>{12});
}

// They lie in their neighbours' planes, along their edges.
TEST(Duplicates, ZeroAreaOverlapsNothing) {
  for (test::LatticeMesh& m : std::vector{test::lattice_box(60), test::lattice_ball(6, 20, 12, 3)}) {
    test::divide_edges(m, 100, 2);
    const Meshed meshed(test::scene_of(m));
    EXPECT_TRUE(find_duplicates(meshed.mesh, meshed.boxes).overlapping.empty());
  }
}

TEST(Duplicates, CommonGroundInOnePlane) {
  Builder b;
  b.face({0, 0, 0}, {4, 0, 0}, {0, 4, 0})
      .face({1, 1, 0}, {5, 1, 0}, {1, 5, 0})
      .face({9, 9, 0}, {9.5, 9, 0}, {9, 9.5, 0});
  EXPECT_EQ(duplicates_of(b).overlapping, (Pairs{{0, 1}}));
}

TEST(Duplicates, OneInsideOfAnother) {
  Builder b;
  b.face({0, 0, 0}, {4, 0, 0}, {0, 4, 0}).face({0.5, 0.5, 0}, {0.5, 1, 0}, {1, 0.5, 0});
  EXPECT_EQ(duplicates_of(b).overlapping, (Pairs{{0, 1}}));
}

// Across the axes no three floats lie exactly in a plane.
TEST(Duplicates, InATiltedPlane) {
  const dvec3 u = glm::normalize(dvec3(1, 2, -0.7)), v = glm::normalize(glm::cross(u, dvec3(0.3, 1, 5)));
  const auto at = [&](double x, double y) { return dvec3(3, 1, 2) + x * u + y * v; };
  Builder b;
  b.face(at(0, 0), at(1, 0), at(0, 1)).face(at(0.2, 0.2), at(1.3, 0.1), at(0.1, 1.2));
  EXPECT_EQ(duplicates_of(b).overlapping, (Pairs{{0, 1}}));
}

TEST(Duplicates, TouchingParallelAndCrossingFacesAreNone) {
  Builder b;
  b.face({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  b.face({1, 0, 0}, {1, 1, 0}, {0, 1, 0});           // the other half
  b.face({0.5, 0, 0}, {0.9, -1, 0}, {0.1, -1, 0});   // a corner on an edge
  b.face({0, 0, 1e-4}, {1, 0, 1e-4}, {0, 1, 1e-4});  // just above
  b.face({0.2, 0.2, -1}, {0.3, 0.2, 1}, {0.2, 0.4, 1});
  EXPECT_TRUE(duplicates_of(b).overlapping.empty());
  EXPECT_TRUE(duplicates_of(b).doubled.empty());
}

// Faces in a few planes on a coarse grid: the tree finds what all pairs find. (Seed 6.)
TEST(Duplicates, TheTreeFindsWhatAllPairsFind) {
  std::mt19937 random(6);
  const auto cell = [&] { return static_cast<double>(random() % 9); };
  Builder b;
  for (int i = 0; i < 1500; ++i) {
    const double z = static_cast<double>(random() % 20), x = 10 * cell(), y = 10 * cell();
    const auto corner = [&] { return dvec3(x + cell(), y + cell(), z); };
    const dvec3 p = corner(), q = corner(), r = corner();
    b.face(p, q, r);
  }
  const Meshed m(b);
  const Duplicates found = find_duplicates(m.mesh, m.boxes);
  const auto doubled = [&](std::uint32_t i) {
    return std::binary_search(found.doubled.begin(), found.doubled.end(), i);
  };
  Pairs all;
  for (std::uint32_t i = 0; i < m.mesh.triangles.size(); ++i)
    for (std::uint32_t j = i + 1; j < m.mesh.triangles.size(); ++j)
      if (!doubled(i) && !doubled(j) && overlap(m.mesh, i, j)) all.emplace_back(i, j);
  EXPECT_GT(all.size(), 50u);
  EXPECT_EQ(found.overlapping, all);
}

}  // namespace
}  // namespace kdray::verify
