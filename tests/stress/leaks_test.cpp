// Nothing gets out of a closed mesh: rays from inside in all directions, at vertices and points of edges,
// along the axes, in splitting planes and from them, for meshes of all scales and far from the origin; every
// traversal, and each like the others.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "stress/meshes.h"
#include "stress/random.h"
#include "stress/table.h"
#include "stress/traced.h"
#include "support/data.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 6;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Ray ray_from(const Origin& o, const dvec3& direction) {
  const vec3 d(direction);
  return {{o.world.x, o.world.y, o.world.z}, 0, {d.x, d.y, d.z}, kInfinity};
}

dvec3 within(const ClosedMesh& mesh, Random& random) {
  const dvec3 lo = mesh.lo(), hi = mesh.hi();
  return {random.uniform(lo.x, hi.x), random.uniform(lo.y, hi.y), random.uniform(lo.z, hi.z)};
}

// A corner of the mesh, or a point of one of its edges.
dvec3 vertex_of(const ClosedMesh& mesh, Random& random) {
  return mesh.corner(random.below(mesh.triangles()), static_cast<int>(random.below(3)));
}
dvec3 edge_point_of(const ClosedMesh& mesh, Random& random) {
  const std::size_t triangle = random.below(mesh.triangles());
  const int k = static_cast<int>(random.below(3));
  const dvec3 a = mesh.corner(triangle, k), b = mesh.corner(triangle, (k + 1) % 3);
  // Points near the ends of the edge are drawn too.
  const double s = random.bits() & 1 ? random.uniform() : random.log_uniform(1e-9, 1);
  return a + s * (b - a);
}

// In each family the origin is inside; what differs is where it is and where the ray goes.
struct Family {
  const char* name;
  dvec3 (*origin)(const ClosedMesh&, Random&, int* axis);
  dvec3 (*direction)(const ClosedMesh&, Random&, const Origin&);
};

dvec3 anywhere(const ClosedMesh& mesh, Random& random, int*) {
  return within(mesh, random);
}
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
dvec3 at_a_vertex(const ClosedMesh& mesh, Random& random, const Origin& o) {
  return vertex_of(mesh, random) - o.local;
}
dvec3 at_an_edge(const ClosedMesh& mesh, Random& random, const Origin& o) {
  return edge_point_of(mesh, random) - o.local;
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

// A winding number takes every triangle.
std::size_t n_origins(const ClosedMesh& mesh) {
  return mesh.triangles() > 10000 ? 64 : (is_full() ? 2048 : 128);
}

// Traces a family's share and expects no leak. `rays`: of each walk.
void trace_family(ClosedMesh& mesh, const Family& family, std::uint64_t seed, std::uint64_t rays,
                  Tally& tally) {
  const std::vector<Origin> origins =
      origins_inside(mesh, seed, n_origins(mesh),
                     [&](Random& random, int* axis) { return family.origin(mesh, random, axis); });
  ASSERT_FALSE(origins.empty());
  const auto make = [&](std::uint64_t i) {
    Random random(seed, i);
    const Origin& o = origins[random.below(origins.size())];
    dvec3 d = family.direction(mesh, random, o);
    if (vec3(d) == vec3(0)) d = dvec3(1, 0, 0);
    return ray_from(o, d);
  };
  trace_all(
      mesh.renderer(), 0, rays, make,
      [](std::uint64_t, const Ray&, const Hit& hit) { return hit.primitive < 0; }, tally);
}

void expect_tight(const Tally& tally) {
  tally.publish();
  EXPECT_EQ(tally.wrong(), 0) << "seed " << kSeed << ", " << tally.first_wrong;
  EXPECT_EQ(tally.differing, 0) << "hits that differ between the traversals: " << tally.first_differing;
}

class Leaks : public testing::TestWithParam<Family> {
 protected:
  void SetUp() override {
    if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }
};
void PrintTo(const Family& f, std::ostream* out) {
  *out << f.name;
}

// Rays are counted as often as they are traced: by five walks, a quarter of them for occlusion too.
constexpr double kTraces = 5 * 1.25;

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
  expect_tight(tally);
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
  expect_tight(tally);
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
  expect_tight(tally);
}

INSTANTIATE_TEST_SUITE_P(Family, Leaks, testing::ValuesIn(kFamilies), [](const auto& info) {
  std::string name(info.param.name);
  for (char& c : name) c = c == ' ' ? '_' : c;
  return name;
});

}  // namespace
}  // namespace kdray::stress
