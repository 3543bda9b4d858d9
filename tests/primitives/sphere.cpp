// Spheres in tests: by the textbook in double, random ones, in exact arithmetic, and hostile ones.
#include <algorithm>
#include <cmath>

#include "conformance/samples.h"
#include "engine/query/exact_distance.h"
#include "oracle/polynomial.h"
#include "oracle/primitives.h"
#include "pictures/stored.h"
#include "stress/exact.h"
#include "stress/self_hits.h"

// ---- As the oracle has them (oracle/primitives.h).
namespace kdray::oracle {

std::optional<Shape> shape_of(const scene::Scene&, const scene::Sphere& s, DBox& box) {
  box.grow(s.center - s.radius), box.grow(s.center + s.radius);
  return Shape{.a = s.center, .r0 = s.radius};
}

Hit intersect(primitives::SphereKind, const Shape& s, const Ray& ray, double grow) {
  const double radius = s.r0 + grow;
  if (radius <= 0) return {};
  const dvec3 o = ray.origin - s.a;
  // The origin lies on the surface itself: one root is 0 by definition, not by what rounding left of it.
  const double c = ray.self == s.number ? 0 : glm::dot(o, o) - radius * radius;
  double t[2];
  const int n = roots(glm::dot(ray.direction, ray.direction), glm::dot(o, ray.direction), c, t);
  for (int i = 0; i < n; ++i)
    if (within(t[i], ray)) return {t[i], s.number};
  return {};
}

void put_surface(primitives::SphereKind, const scene::Scene&, const Shape& s, const Hit&, Surface& out) {
  out.outward = glm::normalize(out.point - s.a);
}

}  // namespace kdray::oracle

namespace kdray::test {

// ---- Random ones (conformance/samples.h).

template <>
void Samples<primitives::SphereKind>::add(scene::Scene& s, std::uint32_t material, Draw& random) {
  const dvec3 center = random.in_cube(1);
  s.spheres.push_back({center, 0.5 * random.size(), material, next_number(s)});
}
template <>
RealPoint Samples<primitives::SphereKind>::point(const scene::SphereGeometry& s, Draw& random) {
  return RealPoint(s.center) + Real(s.radius) * glm::normalize(RealPoint(random.axis_or_any()));
}
// Where it is farthest along an axis, or anywhere.
template <>
Place Samples<primitives::SphereKind>::place(const scene::Scene& s, std::size_t i, Draw& random) {
  const scene::Sphere& sphere = s.spheres[i];
  if (random.below(2) == 0) {
    const dvec3 axis = random.axis();
    return {sphere.center + sphere.radius * axis, dvec3(axis.y, axis.z, axis.x)};
  }
  const dvec3 d = random.direction();
  return {sphere.center + sphere.radius * d, glm::cross(d, random.direction())};
}

// ---- What a struct of the kernels stands for (pictures/stored.h).

// A kind that lacks one does not compile.
scene::Sphere as_told(const layout::Sphere& s) {
  return {dvec3_of(s.center), s.radius, s.material, s.number};
}

// ---- How far a point is, exactly (engine/query/exact_distance.h).

namespace {

template <class N>
N distance(const dvec3& point, const layout::Sphere& s) {
  const Vec<N> w = minus(vec<N>(point), vec<N>(s.center));
  return size_of(N(root(N(dot(w, w))) - N(s.radius)));
}

}  // namespace

KDRAY_DEFINE_DISTANCES(Sphere)

}  // namespace kdray::test

// ---- In exact arithmetic, and hostile ones (stress/exact.h, stress/self_hits.h).
namespace kdray::stress {

std::vector<Exact> roots(const Exact3& o, const Exact3& d, const layout::Sphere& sphere) {
  const Exact3 f = minus(o, exactly(sphere.center));
  const Exact r(sphere.radius);
  return quadratic(dot(d, d), dot(f, d), dot(f, f) - r * r);
}

double distance(const Exact3& p, const layout::Sphere& sphere) {
  const Exact3 f = minus(p, exactly(sphere.center));
  return Exact(sqrt(dot(f, f)) - sphere.radius).get_d();
}

namespace {

scene::Scene spheres(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const double radius = static_cast<float>(random.log_uniform(1e-4, 1e4));
    const dvec3 center(vec3(random.log_uniform(1e-4, 1e6) * random.direction()));
    s.spheres.push_back({center, radius, 0, s.primitive_count()});
  }
  return s;
}

}  // namespace

std::vector<Family> families_of(primitives::SphereKind) {
  return {{"spheres, radius 1e-4 to 1e4, to 1e6 off", spheres, 0.15}};
}

Spot spot_on(const layout::Sphere& s, Random& random) {
  const dvec3 n = random.direction();
  return {point3(s.center) + static_cast<double>(s.radius) * n, n, s.radius};
}

float radius_at(const layout::Sphere& s, const dvec3&) {
  return s.radius;
}

Verdict judge(const layout::Sphere& surface, const Ray& ray, const Hit& hit, const Departure& departure) {
  return judge_solid(surface, ray, hit, departure, false);
}

}  // namespace kdray::stress
