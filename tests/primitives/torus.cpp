// Tori in tests: by the textbook in double, random ones, in exact arithmetic, and hostile ones.
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

namespace {
using RealVec = glm::vec<3, long double>;
}

std::optional<Shape> shape_of(const scene::Scene&, const scene::Torus& t, DBox& box) {
  const double size = t.major_radius + t.minor_radius;
  box.grow(t.center - size), box.grow(t.center + size);
  return Shape{.a = t.center, .r0 = t.major_radius, .r1 = t.minor_radius, .normal = glm::normalize(t.axis)};
}

// About the point of the line that is nearest to the centre.
Hit intersect(primitives::TorusKind, const Shape& s, const Ray& ray, double grow) {
  const long double major = s.r0, minor = s.r1 + grow;
  if (minor <= 0) return {};
  const RealVec d(ray.direction), n = glm::normalize(RealVec(s.normal)),
                                  f = RealVec(ray.origin) - RealVec(s.a);
  const long double a = glm::dot(d, d), middle = -glm::dot(f, d) / a;
  const RealVec g = f + middle * d;
  // Most rays pass the sphere around it, and finding a quartic's roots takes long.
  if (glm::dot(g, g) > (1 + 1e-9L) * (major + minor) * (major + minor)) return {};
  const auto quartic = torus_quartic<long double>(glm::dot(g, g), glm::dot(g, d), a, glm::dot(g, n),
                                                  glm::dot(d, n), major, minor);
  const long double reach = 2 * (major + minor) / std::sqrt(a);
  std::vector<long double> all = roots_of<long double>(quartic, -reach, reach, 80);
  // The origin lies on the surface itself.
  const auto nearest = std::ranges::min_element(all, {}, [&](long double t) { return std::abs(middle + t); });
  if (ray.self == s.number && nearest != all.end() &&
      std::abs(middle + *nearest) * std::sqrt(a) < 1e-6L * major)
    all.erase(nearest);
  for (const long double t : all)
    if (const double at = static_cast<double>(middle + t); within(at, ray)) return {at, s.number};
  return {};
}

void put_surface(primitives::TorusKind, const scene::Scene&, const Shape& s, const Hit&, Surface& out) {
  const dvec3 o = out.point - s.a;
  const double along = glm::dot(o, s.normal);
  out.outward = glm::normalize(o - s.r0 * glm::normalize(o - along * s.normal));
}

}  // namespace kdray::oracle

namespace kdray::test {

// ---- Random ones (conformance/samples.h).

// From one whose hole is all but closed to a thin ring.
template <>
void Samples<primitives::TorusKind>::add(scene::Scene& s, std::uint32_t material, Draw& random) {
  const dvec3 center = random.in_cube(1);
  const double major = 0.5 * random.size(), share = random.below(4) == 0 ? 0.99 : random.between(0.02, 0.7);
  const dvec3 axis = random.between(0.1, 3) * random.axis_or_any();
  s.tori.push_back({center, axis, major, share * major, material, next_number(s)});
}
template <>
RealPoint Samples<primitives::TorusKind>::point(const scene::TorusGeometry& t, Draw& random) {
  const RealPoint center(t.center), axis = glm::normalize(RealPoint(t.axis));
  const RealPoint middle = on_circle(center, axis, t.major_radius, random);
  const RealPoint tangent = glm::normalize(glm::cross(axis, middle - center));
  return on_circle(middle, tangent, t.minor_radius, random);
}
// On the outer or the inner equator, or on top, where a plane touches along a circle; along that circle or
// around the tube.
template <>
Place Samples<primitives::TorusKind>::place(const scene::Scene& s, std::size_t i, Draw& random) {
  const scene::Torus& t = s.tori[i];
  const dvec3 axis = glm::normalize(t.axis);
  const auto [u, v] = across(RealPoint(axis));
  const dvec3 out(u), along(v);
  const Place places[] = {{t.center + (t.major_radius + t.minor_radius) * out, along},
                          {t.center + (t.major_radius + t.minor_radius) * out, axis},
                          {t.center + (t.major_radius - t.minor_radius) * out, along},
                          {t.center + (t.major_radius - t.minor_radius) * out, axis},
                          {t.center + t.major_radius * out + t.minor_radius * axis, along},
                          {t.center + t.major_radius * out + t.minor_radius * axis, out}};
  return places[random.below(6)];
}

// ---- What a struct of the kernels stands for (pictures/stored.h).

scene::Torus as_told(const layout::Torus& t) {
  return {dvec3_of(t.center), dvec3_of(t.axis), t.major_radius, t.minor_radius, t.material, t.number};
}

// ---- How far a point is, exactly (engine/query/exact_distance.h).

namespace {

template <class N>
N distance(const dvec3& point, const layout::Torus& t) {
  const FromAxis<N> from = from_axis(vec<N>(point), vec<N>(t.center), vec<N>(t.axis));
  const N out = from.away - N(t.major_radius);
  return size_of(N(root(N(from.height * from.height + out * out)) - N(t.minor_radius)));
}

}  // namespace

KDRAY_DEFINE_DISTANCES(Torus)

}  // namespace kdray::test

// ---- In exact arithmetic, and hostile ones (stress/exact.h, stress/self_hits.h).
namespace kdray::stress {

// About the place that is nearest to the centre.
std::vector<Exact> roots(const Exact3& o, const Exact3& d, const layout::Torus& torus) {
  const Exact3 f = minus(o, exactly(torus.center)), n = exactly(torus.axis);
  const Exact a = dot(d, d), middle = -dot(f, d) / a, length = sqrt(dot(n, n));
  const Exact3 g = {f.x + middle * d.x, f.y + middle * d.y, f.z + middle * d.z};
  const Exact major(torus.major_radius), minor(torus.minor_radius);
  const auto quartic = oracle::torus_quartic<Exact>(dot(g, g), dot(g, d), a, dot(g, n) / length,
                                                    dot(d, n) / length, major, minor);
  const Exact reach = 2 * (major + minor) / sqrt(a);
  std::vector<Exact> all = oracle::roots_of<Exact>(quartic, -reach, reach, 100);
  for (Exact& t : all) t += middle;
  return all;
}

double distance(const Exact3& p, const layout::Torus& torus) {
  const Exact3 f = minus(p, exactly(torus.center)), n = exactly(torus.axis);
  const Exact z = dot(f, n) / sqrt(dot(n, n)), across2 = dot(f, f) - z * z;
  const Exact out = (sgn(across2) > 0 ? Exact(sqrt(across2)) : Exact(0)) - torus.major_radius;
  return Exact(sqrt(Exact(out * out + z * z)) - torus.minor_radius).get_d();
}

namespace {

// From one whose hole is all but closed to thin rings.
scene::Scene tori(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const double major = static_cast<float>(random.log_uniform(1e-4, 1e4));
    const double minor = i % 3 == 0 ? 0.999 * major : major / random.log_uniform(1.1, 1e3);
    const dvec3 center(vec3(random.log_uniform(1e-4, 1e6) * random.direction()));
    dvec3 axis = random.direction();
    if (i % 4 == 0) axis = dvec3(0), axis[static_cast<int>(random.below(3))] = random.sign();
    s.tori.push_back({center, axis, major, minor, 0, s.primitive_count()});
  }
  return s;
}

}  // namespace

std::vector<Family> families_of(primitives::TorusKind) {
  return {{"tori, radius 1e-4 to 1e4, to 1e6 off", tori, 0.03}};
}

Spot spot_on(const layout::Torus& t, Random& random) {
  const dvec3 axis = glm::normalize(point3(t.axis)), out = tangent_to(axis, random);
  const double angle = 6.283185307179586 * random.uniform();
  const dvec3 n = std::cos(angle) * out + std::sin(angle) * axis;
  return {
      point3(t.center) + static_cast<double>(t.major_radius) * out + static_cast<double>(t.minor_radius) * n,
      n, t.minor_radius};
}

// What is thin of a torus is its tube, or its hole.
float radius_at(const layout::Torus& t, const dvec3&) {
  return std::min(t.minor_radius, t.major_radius - t.minor_radius);
}

// It may meet itself again from outside as well, across its hole or along its inner side.
Verdict judge(const layout::Torus& surface, const Ray& ray, const Hit& hit, const Departure& departure) {
  if (ends_at_the_surface(surface, ray, departure)) return Verdict::excepted;
  const Exact3 o = exactly(ray.origin), d = exactly(ray.direction);
  if (departure.inwards != (distance(o, surface) < 0))
    return may_come_out_again(departure) ? Verdict::excepted : Verdict::wrong;
  if (is_on_the_way(o, d, surface, hit.t)) return Verdict::right;
  return 64 * departure.step > departure.radius ? Verdict::excepted : Verdict::wrong;
}

}  // namespace kdray::stress
