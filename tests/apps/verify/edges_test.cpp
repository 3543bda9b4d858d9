// The topology of meshes whose faults are known.
#include <gtest/gtest.h>

#include <algorithm>

#include "apps/verify/meshes.h"

namespace kdray::verify {
namespace {

TEST(Edges, ACubeIsClosed) {
  const Meshed m(Builder().cube({0, 0, 0}, 1));
  EXPECT_EQ(m.mesh.points.size(), 8u);
  EXPECT_EQ(m.topology.n_edges, 18u);
  EXPECT_TRUE(m.topology.open.empty() && m.topology.crowded.empty() && m.topology.turned.empty());
  ASSERT_EQ(m.topology.components.size(), 1u);
  EXPECT_TRUE(m.topology.components[0].closed());
  EXPECT_EQ(m.topology.components[0].faces, 12u);
  EXPECT_DOUBLE_EQ(m.volume(0), 1);
}

TEST(Edges, InsideOutItsVolumeIsNegative) {
  Builder b;
  b.cube({0, 0, 0}, 2);
  for (scene::Triangle& t : b.scene().triangles) turn_over(t);
  const Meshed m(b);
  ASSERT_TRUE(m.topology.components.at(0).closed());
  EXPECT_DOUBLE_EQ(m.volume(0), -8);
}

TEST(Edges, AMissingSideLeavesFourOpenEdgesInOnePiece) {
  Builder b;
  b.cube({0, 0, 0}, 1);
  b.scene().triangles.erase(b.scene().triangles.begin(), b.scene().triangles.begin() + 2);
  for (std::uint32_t i = 0; i < 10; ++i) b.scene().triangles[i].number = i;
  const Meshed m(b);
  EXPECT_EQ(m.topology.open.size(), 4u);
  EXPECT_EQ(m.topology.loops, 1u);
  EXPECT_FALSE(m.topology.components.at(0).watertight);
  EXPECT_EQ(m.topology.components[0].open_edges, 4u);
}

TEST(Edges, TwoMissingSidesAreTwoPieces) {
  Builder b;
  b.cube({0, 0, 0}, 1);
  b.scene().triangles.erase(b.scene().triangles.begin(),
                            b.scene().triangles.begin() + 4);  // across from each other
  for (std::uint32_t i = 0; i < 8; ++i) b.scene().triangles[i].number = i;
  const Meshed m(b);
  EXPECT_EQ(m.topology.open.size(), 8u);
  EXPECT_EQ(m.topology.loops, 2u);
}

TEST(Edges, OneFaceTurnedOverIsFoundAsThatFace) {
  for (std::size_t face = 0; face < 12; ++face) {
    Builder b;
    b.cube({0, 0, 0}, 1);
    turn_over(b.scene().triangles[face]);
    const Meshed m(b);
    EXPECT_EQ(m.topology.turned.size(), 3u);
    EXPECT_EQ(m.topology.flipped, std::vector<std::uint32_t>{static_cast<std::uint32_t>(face)});
    EXPECT_TRUE(m.topology.components.at(0).watertight);
    EXPECT_FALSE(m.topology.components[0].closed());
  }
}

TEST(Edges, AMoebiusStripHasOneSideAndNoFlippedFace) {
  const Meshed m(Builder().moebius(12));
  ASSERT_EQ(m.topology.components.size(), 1u);
  EXPECT_TRUE(m.topology.components[0].one_sided);
  EXPECT_EQ(m.topology.turned.size(), 1u);
  EXPECT_TRUE(m.topology.flipped.empty());
  EXPECT_EQ(m.topology.open.size(), 24u);
  EXPECT_EQ(m.topology.loops, 1u);  // its one rim
}

TEST(Edges, AFinMakesACrowdedEdge) {
  Builder b;
  b.cube({0, 0, 0}, 1).face({0, 0, 0}, {1, 0, 0}, {0.5, -1, -1});
  const Meshed m(b);
  EXPECT_EQ(m.topology.crowded.size(), 1u);
  EXPECT_EQ(m.topology.open.size(), 2u);
  EXPECT_FALSE(m.topology.components.at(0).watertight);
}

// Two cubes along one edge: four faces there, yet space is parted.
TEST(Edges, CubesThatShareAnEdgeAreWatertightButNotClosed) {
  const Meshed m(Builder().cube({0, 0, 0}, 1).cube({1, 1, 0}, 1));
  ASSERT_EQ(m.topology.components.size(), 1u);
  EXPECT_EQ(m.topology.crowded.size(), 1u);
  EXPECT_TRUE(m.topology.components[0].watertight);
  EXPECT_FALSE(m.topology.components[0].closed());
}

TEST(Edges, ComponentsComeLargestFirstWithTheirOwnFaults) {
  Builder b;
  b.cube({0, 0, 0}, 1).ball({5, 0, 0}, 1, 8).face({9, 0, 0}, {10, 0, 0}, {9, 1, 0});
  const Meshed m(b);
  ASSERT_EQ(m.topology.components.size(), 3u);
  EXPECT_EQ(m.topology.components[0].faces, 2u * 8 * 7);
  EXPECT_EQ(m.topology.components[1].faces, 12u);
  EXPECT_EQ(m.topology.components[2].faces, 1u);
  EXPECT_TRUE(m.topology.components[0].closed() && m.topology.components[1].closed());
  EXPECT_EQ(m.topology.components[2].open_edges, 3u);
  EXPECT_EQ(m.topology.component_of[12 + 112], 2u);
}

// About its own centre, where rays see it.
TEST(Edges, AHugeOffsetOpensNoSeam) {
  const Meshed m(Builder().ball({0, 0, 0}, 1, 16).moved({1e6, -2e6, 3e6}));
  EXPECT_TRUE(m.topology.open.empty());
  ASSERT_EQ(m.topology.components.size(), 1u);
  EXPECT_TRUE(m.topology.components[0].closed());
}

TEST(Edges, MinusZeroIsZero) {
  Builder b;
  b.face({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).face({-0.0, 0, -0.0}, {0, -1, 0}, {1, -0.0, 0});
  EXPECT_EQ(Meshed(b).mesh.points.size(), 4u);
  EXPECT_EQ(Meshed(b).topology.components.size(), 1u);
}

TEST(Edges, NothingHasNoEdges) {
  const Meshed m{scene::Scene{}};
  EXPECT_EQ(m.topology.n_edges, 0u);
  EXPECT_TRUE(m.topology.components.empty());
}

}  // namespace
}  // namespace kdray::verify
