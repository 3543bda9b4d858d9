// Flat discs in tests: by the textbook in double, random ones, in exact arithmetic, and hostile ones.
#include <algorithm>
#include <cmath>
#include <limits>

#include "conformance/samples.h"
#include "engine/query/exact_distance.h"
#include "oracle/primitives.h"
#include "pictures/stored.h"
#include "stress/exact.h"
#include "stress/self_hits.h"

// ---- As the oracle has them (oracle/primitives.h).
namespace kdray::oracle {

std::optional<Shape> shape_of(const scene::Scene&, const scene::Disc& d, DBox& box) {
  box.grow(d.center - d.radius), box.grow(d.center + d.radius);
  return Shape{.a = d.center, .r0 = d.radius, .normal = glm::normalize(d.normal)};
}

// Cuts the ray with the plane, as a triangle does; there it asks for the distance from the centre.
Hit intersect(primitives::DiscKind, const Shape& s, const Ray& ray, double grow) {
  if (ray.self == s.number) return {};
  const double slope = glm::dot(ray.direction, s.normal);
  if (slope == 0) return {};
  const double t = glm::dot(s.a - ray.origin, s.normal) / slope;
  if (!within(t, ray)) return {};
  const double away = glm::length(ray.origin + t * ray.direction - s.a);
  const double moved = grow * glm::length(ray.direction) / std::abs(slope);
  if (!(away <= s.r0 + moved)) return {};
  return {t, s.number, std::min(away / s.r0, 1.0), 0};
}

void put_surface(primitives::DiscKind, const scene::Scene&, const Shape& s, const Hit&, Surface& out) {
  out.outward = s.normal;
}

}  // namespace kdray::oracle

namespace kdray::test {

// ---- Random ones (conformance/samples.h).

template <>
void Samples<primitives::DiscKind>::add(scene::Scene& s, std::uint32_t material, Draw& random) {
  const dvec3 center = random.in_cube(1);
  const dvec3 normal = random.between(0.1, 3) * random.axis_or_any();
  s.discs.push_back({center, normal, random.size(), material, next_number(s)});
}
template <>
RealPoint Samples<primitives::DiscKind>::point(const scene::DiscGeometry& d, Draw& random) {
  const Real radius = d.radius * (random.below(4) == 0 ? 1 : std::sqrt(Real(random.between(0, 1))));
  return on_circle(RealPoint(d.center), glm::normalize(RealPoint(d.normal)), radius, random);
}
// The centre, on the rim, or between.
template <>
Place Samples<primitives::DiscKind>::place(const scene::Scene& s, std::size_t i, Draw& random) {
  const scene::Disc& d = s.discs[i];
  const auto [u, v] = across(glm::normalize(RealPoint(d.normal)));
  const dvec3 out(Real(d.radius) * u), along(Real(d.radius) * v);
  const Place places[] = {{d.center, out}, {d.center + out, along}, {d.center + 0.5 * out, out}};
  return places[random.below(3)];
}

// ---- What a struct of the kernels stands for (pictures/stored.h).

scene::Disc as_told(const layout::Disc& d) {
  return {dvec3_of(d.center), dvec3_of(d.normal), d.radius, d.material, d.number};
}

// ---- How far a point is, exactly (engine/query/exact_distance.h).

namespace {

template <class N>
N distance(const dvec3& point, const layout::Disc& d) {
  const FromAxis<N> from = from_axis(vec<N>(point), vec<N>(d.center), vec<N>(d.normal));
  const N out = from.away > N(d.radius) ? N(from.away - N(d.radius)) : N(0);
  return root(N(from.height * from.height + out * out));
}

}  // namespace

KDRAY_DEFINE_DISTANCES(Disc)

}  // namespace kdray::test

// ---- In exact arithmetic, and hostile ones (stress/exact.h, stress/self_hits.h).
namespace kdray::stress {

// Anywhere in the plane: which hits near the rim are hits, rounding decides.
std::vector<Exact> roots(const Exact3& o, const Exact3& d, const layout::Disc& disc) {
  const Exact3 n = exactly(disc.normal);
  const Exact along = dot(d, n);
  if (sgn(along) == 0) return {};
  return {Exact(dot(minus(exactly(disc.center), o), n) / along)};
}

double distance(const Exact3& p, const layout::Disc& disc) {
  const Exact3 n = exactly(disc.normal);
  return std::abs(Exact(dot(minus(p, exactly(disc.center)), n) / sqrt(dot(n, n))).get_d());
}

namespace {

scene::Scene discs(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const double radius = static_cast<float>(random.log_uniform(1e-4, 1e4));
    const dvec3 center(vec3(random.log_uniform(1e-4, 1e6) * random.direction()));
    dvec3 normal = random.direction();
    if (i % 4 == 0) normal = dvec3(0), normal[static_cast<int>(random.below(3))] = random.sign();
    s.discs.push_back({center, normal, radius, 0, s.primitive_count()});
  }
  return s;
}

}  // namespace

std::vector<Family> families_of(primitives::DiscKind) {
  return {{"discs, radius 1e-4 to 1e4, to 1e6 off", discs, 0.1}};
}

Spot spot_on(const layout::Disc& d, Random& random) {
  const dvec3 n = glm::normalize(point3(d.normal));
  return {point3(d.center) + d.radius * std::sqrt(random.uniform()) * tangent_to(n, random), n, d.radius};
}

float radius_at(const layout::Disc&, const dvec3&) {
  return std::numeric_limits<float>::infinity();
}

Verdict judge(const layout::Disc& surface, const Ray& ray, const Hit&, const Departure& departure) {
  return judge_flat(surface, ray, departure);
}

}  // namespace kdray::stress
