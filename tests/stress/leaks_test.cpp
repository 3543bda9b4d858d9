// Nothing gets out of a closed mesh: rays from inside in all directions, at vertices and points of edges,
// along the axes, in splitting planes and from them, for meshes of all scales and far from the origin; every
// traversal, and each like the others.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "stress/leaks.h"
#include "stress/table.h"
#include "support/data.h"
#include "support/zero_area_meshes.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 6;

// A coordinate of it is that of a splitting plane.
dvec3 on_plane(const ClosedMesh& mesh, Random& random, int* axis) {
  dvec3 p = within(mesh, random);
  if (mesh.planes().empty()) return p;
  const ClosedMesh::Plane& plane = mesh.planes()[random.below(mesh.planes().size())];
  *axis = plane.axis;
  p[plane.axis] = plane.at;
  return p;
}
// Two coordinates of it are those of a vertex or of an edge's point, so that an axis-parallel ray goes
// through that.
dvec3 facing_vertex(const ClosedMesh& mesh, Random& random, int* axis) {
  const dvec3 target = random.bits() & 1 ? vertex_of(mesh, random) : edge_point_of(mesh, random);
  dvec3 p = within(mesh, random);
  *axis = static_cast<int>(random.below(3));
  for (int k = 0; k < 3; ++k)
    if (k != *axis) p[k] = target[k];
  return p;
}

dvec3 everywhere(const ClosedMesh&, Random& random, const Origin&) {
  // Lengths of all kinds: t then is as short or long.
  return random.log_uniform(1e-3, 1e3) * random.direction();
}
dvec3 along_an_axis(const ClosedMesh&, Random& random, const Origin&) {
  dvec3 d(random.sign() * 0.0, random.sign() * 0.0, random.sign() * 0.0);
  d[static_cast<int>(random.below(3))] = random.sign();
  return d;
}
dvec3 along_its_axis(const ClosedMesh&, Random& random, const Origin& o) {
  dvec3 d(random.sign() * 0.0, random.sign() * 0.0, random.sign() * 0.0);
  d[o.axis] = random.sign();
  return d;
}
dvec3 in_its_plane(const ClosedMesh& mesh, Random& random, const Origin& o) {
  dvec3 d = random.bits() & 1 ? random.direction() : vertex_of(mesh, random) - o.local;
  // Now and then all but in it.
  d[o.axis] =
      random.below(4) == 0 ? random.signed_log_uniform(1e-30, 1e-7) * glm::length(d) : random.sign() * 0.0;
  return d == dvec3(0) ? dvec3(o.axis != 0, o.axis == 0, 0) : d;
}

constexpr std::array<Family, 7> kFamilies{
    {{"in all directions", anywhere, everywhere},
     {"at vertices", anywhere, at_a_vertex},
     {"at points of edges", anywhere, at_an_edge},
     {"along the axes", anywhere, along_an_axis},
     {"along the axes through vertices and edges", facing_vertex, along_its_axis},
     {"in splitting planes", on_plane, in_its_plane},
     {"from splitting planes at vertices", on_plane, at_a_vertex}}};

class Leaks : public testing::TestWithParam<Family> {
 protected:
  void SetUp() override {
    if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }
};

TEST_P(Leaks, SmallMeshes) {
  const double share = 0.5 / static_cast<double>(kFamilies.size());
  Tally tally("leaks", std::string("small meshes, ") + GetParam().name);
  std::vector<NamedMesh> meshes = small_closed_meshes();
  const auto rays = rays_to_trace(share / static_cast<double>(meshes.size()) / kTraces);
  for (NamedMesh& m : meshes) {
    SCOPED_TRACE(m.name);
    ASSERT_TRUE(is_closed(m.scene));
    ClosedMesh mesh(std::move(m.scene));
    trace_family(mesh, GetParam(), kSeed, rays, tally);
  }
  expect_tight(tally, kSeed);
}

// 1e-30 to 1e30 times as large, moved by up to a million times the size.
TEST_P(Leaks, ScaledAndMoved) {
  const std::vector<double> scales =
      is_full() ? std::vector<double>{1e-30, 1e-14, 1e-6, 1e-3, 1, 1e3, 1e6, 1e14, 1e30}
                : std::vector<double>{1e-30, 1e-6, 1e6, 1e30};
  const std::vector<double> moves =
      is_full() ? std::vector<double>{0, 1, 1e3, 1e6} : std::vector<double>{1e3, 1e6};
  const double share =
      0.3 / static_cast<double>(kFamilies.size()) / static_cast<double>(2 * scales.size() * moves.size());
  const auto rays = rays_to_trace(share / kTraces);
  Tally tally("leaks", std::string("scaled and moved, ") + GetParam().name);
  for (const double scale : scales)
    for (const double move : moves)
      for (scene::Scene (*make)() : {cube, crumpled}) {
        SCOPED_TRACE(testing::Message() << "scale " << scale << " moved by " << move << " sizes");
        ClosedMesh mesh(placed(make(), scale, scale * move * dvec3(1, -0.7, 0.3)));
        trace_family(mesh, GetParam(), kSeed + 1, rays, tally);
      }
  expect_tight(tally, kSeed);
}

TEST_P(Leaks, RealMeshes) {
  const double share = 0.2 / static_cast<double>(kFamilies.size());
  Tally tally("leaks", std::string("bunny, ") + GetParam().name);
  const std::filesystem::path file = test::data_path("stanford/bunny_closed_75k.ply.xz");
  KDRAY_NEED_DATA(file);
  const Scene scene = Scene::load(file);
  ASSERT_TRUE(is_closed(scene.model()));
  ClosedMesh mesh{scene::Scene(scene.model())};
  trace_family(mesh, GetParam(), kSeed + 2, rays_to_trace(share / kTraces), tally);
  expect_tight(tally, kSeed);
}

// Where the sizes are powers of two or the place is a whole number, the grid's numbers are the kernels' and
// what was made without area has none; elsewhere rounding bends it. The quick part has every mesh as it is,
// and each somewhere else.
TEST_P(Leaks, ZeroArea) {
  struct Place {
    double scale, sizes_away;
  };
  const std::vector<Place> places{{1, 0}, {0x1p-40, 0}, {1, 1e6}, {1e-6, 3}};
  const std::vector<test::LatticeMesh> meshes = test::zero_area_meshes();
  const double n_cases = static_cast<double>(meshes.size() * (is_full() ? places.size() : 2));
  const auto rays = rays_to_trace(0.3 / static_cast<double>(kFamilies.size()) / n_cases / kTraces);
  Tally tally("leaks", std::string("divided, ") + GetParam().name);
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (std::size_t p = 0; p < places.size(); ++p) {
      if (!is_full() && p != 0 && p != 1 + m % 3) continue;
      const auto& [scale, sizes_away] = places[p];
      SCOPED_TRACE(testing::Message()
                   << meshes[m].name << ", scale " << scale << " moved by " << sizes_away << " sizes");
      scene::Scene scene = test::scene_of(meshes[m]);
      ASSERT_TRUE(is_closed(scene));
      const double away = std::round(sizes_away * scene.bounds().extent().x);
      ClosedMesh mesh(placed(std::move(scene), scale, scale * away * dvec3(1, -2, 3)));
      trace_family(mesh, GetParam(), kSeed + 3, rays, tally);
    }
  expect_tight(tally, kSeed);
}

INSTANTIATE_TEST_SUITE_P(Family, Leaks, testing::ValuesIn(kFamilies),
                         [](const auto& info) { return name_of_test(info.param); });

}  // namespace
}  // namespace kdray::stress
