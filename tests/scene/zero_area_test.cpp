// The normals that zero-area triangles are shaded by.
#include "scene/model/zero_area.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "scene/model/geometry.h"
#include "support/zero_area_meshes.h"

namespace kdray::scene {
namespace {

Array<layout::Triangle> triangles_of(const std::vector<std::array<vec3, 3>>& corners) {
  Array<layout::Triangle> triangles(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    layout::Triangle t{};
    for (std::size_t v = 0; v < 3; ++v)
      for (int k = 0; k < 3; ++k) t.v[v][k] = corners[i][v][k];
    t.normals = is_flat(t) ? 0xffffffffu : KDRAY_NO_NORMALS;
    triangles[i] = t;
  }
  return triangles;
}

const vec3 kA(0, 0, 0), kB(1, 0, 0), kC(4, 0, 0);
const std::array<vec3, 3> kUndivided{kA, kC, vec3(2, 3, 0)}, kZeroArea{kC, kB, kA};
const std::array<vec3, 3> kOne{kB, kA, vec3(0, 0, -3)}, kTwo{kC, kB, vec3(0, 0, -3)};

TEST(ZeroAreaTriangles, AreShadedByTheFaceAtTheLongestEdge) {
  std::vector<std::array<vec3, 3>> all{kOne, kZeroArea, kTwo, kUndivided};
  for (int order = 0; order < 24; ++order) {
    std::next_permutation(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return std::lexicographical_compare(&a[0].x, &a[0].x + 9, &b[0].x, &b[0].x + 9);
    });
    const auto found = find_zero_area(triangles_of(all));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(all[found[0].triangle], kZeroArea);
    EXPECT_EQ(found[0].normal, vec3(0, 0, 1));
  }
}

TEST(ZeroAreaTriangles, TakeAnotherWhereThatIsNone) {
  const auto found = find_zero_area(triangles_of({kZeroArea, kOne, kTwo}));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].normal, vec3(0, -1, 0));
}

// The corner at 0 is written with either sign.
TEST(ZeroAreaTriangles, KnowMinusZero) {
  const auto found = find_zero_area(triangles_of({{kC, kB, vec3(-0.0f)}, kUndivided}));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].normal, vec3(0, 0, 1));
}

TEST(ZeroAreaTriangles, HandNormalsOn) {
  std::vector<std::array<vec3, 3>> chain{kUndivided};
  // Each shares an edge with the last.
  for (int i = 0; i < 1000; ++i) {
    const float x = 4 - static_cast<float>(i) * 0x1p-9f;
    chain.push_back({kA, vec3(x, 0, 0), vec3(x - 0x1p-9f, 0, 0)});
  }
  std::shuffle(chain.begin(), chain.end(), std::mt19937(1));
  const auto found = find_zero_area(triangles_of(chain));
  ASSERT_EQ(found.size(), 1000u);
  for (const ZeroAreaTriangle& s : found) EXPECT_EQ(s.normal, vec3(0, 0, 1));
}

TEST(ZeroAreaTriangles, MayHaveNoNeighbour) {
  const auto found = find_zero_area(triangles_of({kZeroArea, {vec3(9), vec3(8), vec3(7)}}));
  ASSERT_EQ(found.size(), 2u);
  for (const ZeroAreaTriangle& s : found) EXPECT_EQ(s.normal, vec3(0));
}

// In meshes of many every one has a neighbour, and is at right angles to its normal.
TEST(ZeroAreaTriangles, OfMeshesLieInTheirNeighbours) {
  for (const test::LatticeMesh& m : test::zero_area_meshes()) {
    SCOPED_TRACE(m.name);
    const Geometry g = make_geometry(test::scene_of(m));
    EXPECT_EQ(g.zero_area.size(), m.n_without_area());
    EXPECT_EQ(g.dropped_degenerate, 0u);
    EXPECT_EQ(g.lost, 0u);
    for (const ZeroAreaTriangle& s : g.zero_area) {
      EXPECT_NEAR(glm::length(s.normal), 1, 1e-6);
      const vec3 edge = vertex(g.triangles[s.triangle], 1) - vertex(g.triangles[s.triangle], 0);
      EXPECT_LT(std::abs(glm::dot(glm::normalize(edge), s.normal)), 1e-5);
    }
  }
}

}  // namespace
}  // namespace kdray::scene
