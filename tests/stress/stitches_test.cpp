// Meshes on a grid of whole numbers whose T-junctions are closed by triangles without area: rays between points
// of the grid, exactly through corners and along edges, by every walk and in double; without these triangles
// such rays do leak. And what becomes of rays that hit such a triangle or leave its neighbours.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "stress/leaks.h"
#include "stress/spawn.h"
#include "stress/table.h"
#include "support/stitched_meshes.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 25;

// To where the kernels' floats of the largest coordinates are whole; every mesh's grid is part of that one.
dvec3 onto_grid(const dvec3& p) {
  constexpr double kUnit = 0x1p-12;
  return glm::round(p / kUnit) * kUnit;
}

// The origin knows what it lies by: the k-th corner of a triangle, as 3 * triangle + k.
dvec3 corner_of(const ClosedMesh& mesh, int which) {
  return mesh.corner(static_cast<std::size_t>(which / 3), which % 3);
}
int some_corner(const ClosedMesh& mesh, Random& random) {
  return static_cast<int>(random.below(3 * mesh.triangles()));
}

int next_corner(int which) {
  return which / 3 * 3 + (which + 1) % 3;
}

// Nearer than this to an edge, rounding decides what is hit (docs/design/stress.md): 16 units of roundoff of
// the distance of its ends, which is below 4096 here.
constexpr double kSure = 0x1p-8;

double distance_from_edge(const dvec3& p, const dvec3& a, const dvec3& b) {
  const dvec3 e = b - a;
  const double s = std::clamp(glm::dot(p - a, e) / glm::dot(e, e), 0.0, 1.0);
  return glm::length(a + s * e - p);
}

// The point, or one outside of the mesh where it is too near to an edge.
dvec3 if_sure(const ClosedMesh& mesh, const dvec3& p) {
  for (int i = 0; i < static_cast<int>(3 * mesh.triangles()); ++i)
    if (distance_from_edge(p, corner_of(mesh, i), corner_of(mesh, next_corner(i))) < kSure)
      return 2.0 * mesh.hi();
  return p;
}

dvec3 near_a_corner(const ClosedMesh& mesh, Random& random, int* which) {
  *which = some_corner(mesh, random);
  return if_sure(mesh,
                 onto_grid(corner_of(mesh, *which) + random.log_uniform(kSure, 0x1p9) * random.direction()));
}
dvec3 at_that_corner(const ClosedMesh& mesh, Random&, const Origin& o) {
  return corner_of(mesh, o.axis) - o.local;
}
dvec3 at_that_edge(const ClosedMesh& mesh, Random& random, const Origin& o) {
  return glm::mix(corner_of(mesh, o.axis), corner_of(mesh, next_corner(o.axis)), random.uniform()) - o.local;
}

// On the way on from an edge's end; the ray goes back along the edge.
dvec3 beyond_an_edge(const ClosedMesh& mesh, Random& random, int* which) {
  *which = some_corner(mesh, random);
  const dvec3 a = corner_of(mesh, *which), b = corner_of(mesh, next_corner(*which));
  return if_sure(mesh, a + std::ldexp(1.0, static_cast<int>(random.below(8)) - 6) * (a - b));
}
dvec3 along_that_edge(const ClosedMesh& mesh, Random&, const Origin& o) {
  return corner_of(mesh, next_corner(o.axis)) - corner_of(mesh, o.axis);
}

constexpr std::array<Family, 3> kFamilies{{{"from the grid at corners nearby", near_a_corner, at_that_corner},
                                           {"from the grid at edges nearby", near_a_corner, at_that_edge},
                                           {"along edges", beyond_an_edge, along_that_edge}}};

class Stitches : public testing::TestWithParam<Family> {
 protected:
  void SetUp() override {
    if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }
};

std::size_t n_stitches(const scene::Scene& scene) {
  return scene::make_geometry(scene).stitches.size();
}

TEST_P(Stitches, CloseWhatTheyAreMadeToClose) {
  Tally tally("leaks", std::string("stitched, ") + GetParam().name);
  const std::vector<test::LatticeMesh> meshes = test::stitched_meshes();
  const auto rays = rays_to_trace(0.2 / static_cast<double>(kFamilies.size() * meshes.size()) / kTraces);
  for (const test::LatticeMesh& m : meshes) {
    SCOPED_TRACE(m.name);
    scene::Scene scene = test::scene_of(m);
    ASSERT_EQ(n_stitches(scene), m.n_without_area());
    ClosedMesh mesh(std::move(scene));
    const RaysInside make(mesh, GetParam(), kSeed);
    // No edge of a box leads to its inside.
    if (!make.any()) continue;
    trace_family(mesh, GetParam(), kSeed, rays, tally);
  }
  expect_tight(tally, kSeed);
}

std::uint64_t n_leaks(ClosedMesh& mesh, const RaysInside& make, std::size_t rays, Precision precision) {
  const std::vector<Hit> hits =
      mesh.renderer().trace(make_rays(0, rays, make), false, 1, Traversal::binary, precision);
  return static_cast<std::uint64_t>(std::count_if(hits.begin(), hits.end(), is_leak));
}

TEST_P(Stitches, CloseThemInDoubleToo) {
  Row row{"leaks", std::string("stitched, ") + GetParam().name, "double"};
  const std::vector<test::LatticeMesh> meshes = test::stitched_meshes();
  const auto rays = rays_to_trace(0.05 / static_cast<double>(kFamilies.size() * meshes.size()));
  for (const test::LatticeMesh& m : meshes) {
    SCOPED_TRACE(m.name);
    ClosedMesh mesh(test::scene_of(m));
    const RaysInside make(mesh, GetParam(), kSeed + 1);
    if (!make.any()) continue;
    const std::uint64_t leaks = n_leaks(mesh, make, rays, Precision::float64);
    row.rays += rays, row.wrong += leaks;
    EXPECT_EQ(leaks, 0u) << "seed " << kSeed + 1;
  }
  add(row);
}

// The tests above would see it.
TEST(StitchesLeftOut, LetRaysOut) {
  if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  std::uint64_t leaks = 0;
  for (test::LatticeMesh m : test::stitched_meshes()) {
    std::vector<std::array<std::uint32_t, 3>> with_area;
    for (std::size_t i = 0; i < m.triangles.size(); ++i)
      if (m.has_area(i)) with_area.push_back(m.triangles[i]);
    m.triangles = with_area;
    ClosedMesh mesh(test::scene_of(m));
    const RaysInside make(mesh, kFamilies[0], kSeed);
    leaks += n_leaks(mesh, make, 20000, Precision::float32);
  }
  EXPECT_GT(leaks, 100u);
}

INSTANTIATE_TEST_SUITE_P(Family, Stitches, testing::ValuesIn(kFamilies),
                         [](const auto& info) { return name_of_test(info.param); });

}  // namespace
}  // namespace kdray::stress
