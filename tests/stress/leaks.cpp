#include "stress/leaks.h"

#include <gtest/gtest.h>

#include <limits>

#include "stress/table.h"

namespace kdray::stress {

namespace {

Ray ray_from(const Origin& o, const dvec3& direction) {
  const vec3 d(direction);
  return {{o.world.x, o.world.y, o.world.z}, 0, {d.x, d.y, d.z}, std::numeric_limits<float>::infinity()};
}

// A winding number takes every triangle.
std::size_t n_origins(const ClosedMesh& mesh) {
  return mesh.triangles() > 10000 ? 64 : (is_full() ? 2048 : 128);
}

}  // namespace

void PrintTo(const Family& f, std::ostream* out) {
  *out << f.name;
}

std::string name_of_test(const Family& f) {
  std::string name(f.name);
  for (char& c : name) c = c == ' ' ? '_' : c;
  return name;
}

dvec3 within(const ClosedMesh& mesh, Random& random) {
  const dvec3 lo = mesh.lo(), hi = mesh.hi();
  return {random.uniform(lo.x, hi.x), random.uniform(lo.y, hi.y), random.uniform(lo.z, hi.z)};
}

dvec3 anywhere(const ClosedMesh& mesh, Random& random, int*) {
  return within(mesh, random);
}

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

dvec3 at_a_vertex(const ClosedMesh& mesh, Random& random, const Origin& o) {
  return vertex_of(mesh, random) - o.local;
}
dvec3 at_an_edge(const ClosedMesh& mesh, Random& random, const Origin& o) {
  return edge_point_of(mesh, random) - o.local;
}

RaysInside::RaysInside(const ClosedMesh& mesh, const Family& family, std::uint64_t seed)
    : mesh_(mesh),
      family_(family),
      seed_(seed),
      origins_(origins_inside(mesh, seed, n_origins(mesh),
                              [&](Random& random, int* axis) { return family.origin(mesh, random, axis); })) {
}

Ray RaysInside::operator()(std::uint64_t i) const {
  Random random(seed_, i);
  const Origin& o = origins_[random.below(origins_.size())];
  dvec3 d = family_.direction(mesh_, random, o);
  if (vec3(d) == vec3(0)) d = dvec3(1, 0, 0);
  return ray_from(o, d);
}

void trace_family(ClosedMesh& mesh, const Family& family, std::uint64_t seed, std::uint64_t rays,
                  Tally& tally) {
  const RaysInside make(mesh, family, seed);
  ASSERT_TRUE(make.any());
  trace_all(
      mesh.renderer(), 0, rays, make, [](std::uint64_t, const Ray&, const Hit& hit) { return is_leak(hit); },
      tally);
}

void expect_tight(const Tally& tally, std::uint64_t seed) {
  tally.publish();
  EXPECT_EQ(tally.wrong(), 0) << "seed " << seed << ", " << tally.first_wrong;
  EXPECT_EQ(tally.differing, 0) << "hits that differ between the traversals: " << tally.first_differing;
}

}  // namespace kdray::stress
