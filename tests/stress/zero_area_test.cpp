// Meshes on a grid of whole numbers whose T-junctions are closed by triangles without area: rays between
// points of the grid, exactly through corners and along edges, by every walk and in double; without these
// triangles such rays do leak. And what becomes of rays that hit such a triangle or leave its neighbours.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "stress/leaks.h"
#include "stress/spawn.h"
#include "stress/table.h"
#include "support/zero_area_meshes.h"

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

// Nearer than this to a face or an edge, rounding may decide what is hit (docs/design/stress.md): 16 units of
// roundoff of the distance of its corners, which is below 4096 here.
constexpr double kSure = 0x1p-8;

double distance_from_edge(const dvec3& p, const dvec3& a, const dvec3& b) {
  const dvec3 e = b - a;
  const double s = std::clamp(glm::dot(p - a, e) / glm::dot(e, e), 0.0, 1.0);
  return glm::length(a + s * e - p);
}

// From its plane, where that is nearest within it; else infinite.
double distance_from_inner(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
  const dvec3 n = glm::cross(b - a, c - a);
  const auto left = [&](const dvec3& from, const dvec3& to) {
    return glm::dot(n, glm::cross(to - from, p - from)) > 0;
  };
  return left(a, b) && left(b, c) && left(c, a) ? std::abs(glm::dot(n, p - a)) / glm::length(n)
                                                : std::numeric_limits<double>::infinity();
}

// The point, or one outside of the mesh where it is too near to it.
dvec3 if_sure(const ClosedMesh& mesh, const dvec3& p) {
  for (std::size_t t = 0; t < mesh.triangles(); ++t) {
    const dvec3 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    const double distance = std::min({distance_from_edge(p, a, b), distance_from_edge(p, b, c),
                                      distance_from_edge(p, c, a), distance_from_inner(p, a, b, c)});
    if (distance < kSure) return 2.0 * mesh.hi();
  }
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

class ZeroAreaTriangles : public testing::TestWithParam<Family> {
 protected:
  void SetUp() override {
    if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }
};

std::size_t n_zero_area(const scene::Scene& scene) {
  return scene::make_geometry(scene).zero_area.size();
}

TEST_P(ZeroAreaTriangles, CloseWhatTheyAreMadeToClose) {
  Tally tally("leaks", std::string("divided, ") + GetParam().name);
  const std::vector<test::LatticeMesh> meshes = test::zero_area_meshes();
  const auto rays = rays_to_trace(0.2 / static_cast<double>(kFamilies.size() * meshes.size()) / kTraces);
  for (const test::LatticeMesh& m : meshes) {
    SCOPED_TRACE(m.name);
    scene::Scene scene = test::scene_of(m);
    ASSERT_EQ(n_zero_area(scene), m.n_without_area());
    ClosedMesh mesh(std::move(scene));
    const RaysInside make(mesh, GetParam(), kSeed);
    // No edge of a box leads to its inside.
    if (!make.any()) continue;
    trace_family(mesh, GetParam(), kSeed, rays, tally);
  }
  expect_tight(tally, kSeed);
}

std::uint64_t n_leaks(ClosedMesh& mesh, const RaysInside& make, std::size_t rays, Precision precision) {
  const bool wide = precision == Precision::float32;
  const std::vector<Hit> hits = mesh.renderer().trace(make_rays(0, rays, make), false, 1,
                                                      wide ? Traversal::wide : Traversal::binary, precision);
  return static_cast<std::uint64_t>(std::count_if(hits.begin(), hits.end(), is_leak));
}

TEST_P(ZeroAreaTriangles, CloseThemInDoubleToo) {
  Row row{"leaks", std::string("divided, ") + GetParam().name, "double"};
  const std::vector<test::LatticeMesh> meshes = test::zero_area_meshes();
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
TEST(WithoutZeroAreaTriangles, RaysLeak) {
  if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  std::uint64_t leaks = 0;
  for (test::LatticeMesh m : test::zero_area_meshes()) {
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

// ---- Rays that begin at edges

// Nearer than kSure, where some of them do leak: counted, and few.
dvec3 at_an_edge_nearly(const ClosedMesh& mesh, Random& random, int* which) {
  *which = some_corner(mesh, random);
  const dvec3 p = glm::mix(corner_of(mesh, *which), corner_of(mesh, next_corner(*which)), random.uniform());
  return p + random.log_uniform(0x1p-14, kSure) * random.direction();
}
dvec3 anywhere_else(const ClosedMesh&, Random& random, const Origin&) {
  return random.direction();
}
constexpr std::array<Family, 2> kNearEdges{{{"at the edge", at_an_edge_nearly, at_that_edge},
                                            {"in all directions", at_an_edge_nearly, anywhere_else}}};

TEST(NearEdges, FewRaysLeakWithZeroAreaAndWithout) {
  if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  for (const Family& family : kNearEdges)
    for (const bool divided : {false, true}) {
      Row row{"near edges", std::string(family.name) + (divided ? ", divided" : ""), "wide"};
      for (test::LatticeMesh m : {test::lattice_box(60), test::lattice_ball(6, 20, 12, 3),
                                  test::lattice_ball(16, 1 << 15, 1 << 7, 4)}) {
        if (divided) test::divide_edges(m, m.triangles.size(), 7);
        ClosedMesh mesh(test::scene_of(m));
        const RaysInside make(mesh, family, kSeed + 3);
        ASSERT_TRUE(make.any());
        const auto rays = rays_to_trace(0.01);
        row.rays += rays;
        row.exceptions += n_leaks(mesh, make, rays, Precision::float32);
      }
      EXPECT_LT(static_cast<double>(row.exceptions), 1e-3 * static_cast<double>(row.rays)) << row.family;
      add(row);
    }
}

// ---- Rays that leave zero-area triangles

dvec3 point3(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

// A mesh in the kernels' own space, the rays that hit its zero-area triangles, and those that leave them.
class LeavingRays {
 public:
  explicit LeavingRays(const test::LatticeMesh& m)
      : scene_(in_local_space(test::scene_of(m))),
        geometry_(scene::make_geometry(scene_)),
        mesh_(scene::Scene(scene_)),
        prepared_(Scene{scene::Scene(scene_)}),
        spawner_(prepared_.prepared()) {
    for (const scene::ZeroAreaTriangle& s : geometry_.zero_area) normals_[s.triangle] = s.normal;
  }

  Renderer& renderer() { return mesh_.renderer(); }

  // n rays at edges; of their hits those on zero-area triangles.
  void hit(std::size_t n) {
    const RaysInside make(mesh_, kFamilies[1], kSeed + 2);
    const std::vector<Ray> rays = make_rays(0, n, make);
    const std::vector<Hit> hits = mesh_.renderer().trace(rays);
    for (std::size_t i = 0; i < n; ++i) {
      if (is_leak(hits[i])) continue;
      const auto triangle = static_cast<std::uint32_t>(hits[i].primitive);  // none was dropped
      if (!normals_.contains(triangle)) continue;
      const Ray& r = rays[i];
      const dvec3 d = glm::normalize(point3(r.direction)),
                  light = point3(r.origin) + 0.1 * dvec3(d.y, -d.z, d.x);
      hits_.push_back(
          {{r.origin[0], r.origin[1], r.origin[2]},
           {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)},
           hits[i].t,
           KDRAY_KIND_TRIANGLE << KDRAY_REF_KIND_SHIFT | triangle,
           hits[i].u,
           hits[i].v,
           {static_cast<float>(light.x), static_cast<float>(light.y), static_cast<float>(light.z)},
           1.3f});
    }
    if (!hits_.empty()) spawned_ = spawner_.spawn(hits_);
  }
  std::size_t n_hits() const { return hits_.size(); }

  // Each has the normal of a neighbour, turned against the ray.
  void expect_neighbours_normals() const {
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      const dvec3 n = point3(spawned_[i].normal), expected(normals_.at(hits_[i].ref & KDRAY_REF_INDEX_MASK));
      ASSERT_LE(std::min(glm::length(n - expected), glm::length(n + expected)), 1e-6) << "hit " << i;
      ASSERT_LE(glm::dot(n, point3(hits_[i].direction)), 0) << "hit " << i;
      ASSERT_TRUE(is_finite(point3(spawned_[i].above)) && is_finite(point3(spawned_[i].below)))
          << "hit " << i;
    }
  }

  // What leaves the hits: reflected, refracted and towards a light.
  void leave() {
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      const Spawned& s = spawned_[i];
      put(i, s.above, s.reflected);
      if (s.flags & kRefracts) put(i, s.below, s.refracted);
      if (s.flags & kLit) put(i, s.above, s.to_light);
    }
  }
  const std::vector<Ray>& rays() const { return rays_; }
  bool is_self_hit(std::size_t i, const Hit& hit) const {
    return hit.primitive >= 0 && static_cast<std::uint32_t>(hit.primitive) == from_[i];
  }

 private:
  static scene::Scene in_local_space(scene::Scene scene) {
    const LocalSpace space = scene::make_geometry(scene).space;
    return placed(std::move(scene), space.scale, -space.center * space.scale);
  }

  void put(std::size_t i, const float (&o)[3], const float (&d)[3]) {
    rays_.push_back({{o[0], o[1], o[2]}, 0, {d[0], d[1], d[2]}, std::numeric_limits<float>::infinity()});
    from_.push_back(hits_[i].ref & KDRAY_REF_INDEX_MASK);
  }

  scene::Scene scene_;
  scene::Geometry geometry_;
  ClosedMesh mesh_;
  PreparedScene prepared_;
  Spawner spawner_;
  std::map<std::uint32_t, vec3> normals_;  // by triangle
  std::vector<ToSpawn> hits_;
  std::vector<Spawned> spawned_;
  std::vector<Ray> rays_;
  std::vector<std::uint32_t> from_;
};

// By the code that shades, and without telling the walks what a ray has left.
TEST(ZeroAreaTrianglesLeft, AreNotHitAgainAndShadedAsTheirNeighbours) {
  if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  Tally tally("re-hits", "zero area");
  std::size_t n_hits = 0;
  for (const test::LatticeMesh& m : test::zero_area_meshes()) {
    SCOPED_TRACE(m.name);
    LeavingRays leaving(m);
    leaving.hit(rays_to_trace(0.05));
    n_hits += leaving.n_hits();
    ASSERT_NO_FATAL_FAILURE(leaving.expect_neighbours_normals());
    leaving.leave();
    trace_all(
        leaving.renderer(), 0, leaving.rays().size(), [&](std::uint64_t i) { return leaving.rays()[i]; },
        [&](std::uint64_t i, const Ray&, const Hit& hit) { return leaving.is_self_hit(i, hit); }, tally);
  }
  EXPECT_GT(n_hits, 10000u);
  tally.publish();
  EXPECT_EQ(tally.wrong(), 0u) << tally.first_wrong;
  EXPECT_EQ(tally.differing, 0u) << tally.first_differing;
}

INSTANTIATE_TEST_SUITE_P(Family, ZeroAreaTriangles, testing::ValuesIn(kFamilies),
                         [](const auto& info) { return name_of_test(info.param); });

}  // namespace
}  // namespace kdray::stress
