// Truncated cones in tests: by the textbook in double, random ones, in exact arithmetic, and hostile ones.
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

std::optional<Shape> shape_of(const scene::Scene&, const scene::Cone& c, DBox& box) {
  const double r = std::max(c.base_radius, c.apex_radius);
  for (const dvec3& end : {c.base, c.apex}) box.grow(end - r), box.grow(end + r);
  return Shape{.a = c.base, .b = c.apex, .r0 = c.base_radius, .r1 = c.apex_radius};
}

// The points whose distance from the axis equals r0 + k*h, h being the way along the axis from the base.
Hit intersect(primitives::ConeKind, const Shape& s, const Ray& ray, double grow) {
  const double length = glm::length(s.b - s.a);
  const dvec3 axis = (s.b - s.a) / length;
  const double k = (s.r1 - s.r0) / length;
  const dvec3 o = ray.origin - s.a;
  const double h0 = glm::dot(o, axis), dh = glm::dot(ray.direction, axis);
  const dvec3 across = o - h0 * axis, d_across = ray.direction - dh * axis;
  const double radius = s.r0 + grow + k * h0;
  const double a = glm::dot(d_across, d_across) - k * k * dh * dh;
  const double b = glm::dot(across, d_across) - k * radius * dh;
  const double c = ray.self == s.number ? 0 : glm::dot(across, across) - radius * radius;
  double t[2];
  const int n = roots(a, b, c, t);
  for (int i = 0; i < n; ++i) {
    const double h = h0 + t[i] * dh;
    // Grown radii make a second nappe begin inside the segment of a pointed cone: its radius is negative.
    const bool on_segment = h >= -grow && h <= length + grow && s.r0 + grow + k * h >= 0;
    if (on_segment && within(t[i], ray)) return {t[i], s.number, std::clamp(h / length, 0.0, 1.0), 0};
  }
  return {};
}

void put_surface(primitives::ConeKind, const scene::Scene&, const Shape& s, const Hit&, Surface& out) {
  const double length = glm::length(s.b - s.a);
  const dvec3 axis = (s.b - s.a) / length;
  const dvec3 o = out.point - s.a;
  const dvec3 across = o - glm::dot(o, axis) * axis;
  const double radius = glm::length(across);
  // At the very point of a cone there is no normal: the axis, away from the body, is as good as any.
  const double k = (s.r1 - s.r0) / length;
  out.outward = radius > 0 ? glm::normalize(across / radius - k * axis) : axis * (k < 0 ? 1.0 : -1.0);
}

}  // namespace kdray::oracle

namespace kdray::test {

// ---- Random ones (conformance/samples.h).

template <>
void Samples<primitives::ConeKind>::add(scene::Scene& s, std::uint32_t material, Draw& random) {
  const dvec3 base = random.in_cube(1);
  const double size = random.size(), radius = 0.3 * size;
  const dvec3 apex = base + size * random.axis_or_any();
  const double apex_radius = random.below(3) == 0 ? 0 : random.between(0, radius);
  s.cones.push_back({base, apex, radius, apex_radius, material, next_number(s)});
}
// Often on a rim.
template <>
RealPoint Samples<primitives::ConeKind>::point(const scene::ConeGeometry& c, Draw& random) {
  const RealPoint base(c.base), axis = RealPoint(c.apex) - base;
  const Real share = random.below(4) == 0 ? Real(random.below(2)) : Real(random.between(0, 1));
  const Real radius = c.base_radius + share * (Real(c.apex_radius) - Real(c.base_radius));
  return on_circle(base + share * axis, glm::normalize(axis), radius, random);
}
// At the foot, half-way up, at the tip or within the upper rim.
template <>
Place Samples<primitives::ConeKind>::place(const scene::Scene& s, std::size_t i, Draw& random) {
  const scene::Cone& c = s.cones[i];
  const dvec3 axis = c.apex - c.base, side = glm::normalize(glm::cross(axis, random.direction()));
  const dvec3 foot = c.base + c.base_radius * side, slope = c.apex + c.apex_radius * side - foot;
  const Place places[] = {{foot, slope}, {foot + 0.5 * slope, slope}, {c.apex, axis}};
  return places[random.below(3)];
}

// ---- What a struct of the kernels stands for (pictures/stored.h).

scene::Cone as_told(const layout::Cone& c) {
  const double height = c.height, base_radius = c.base_radius, slope = c.slope;
  const dvec3 base = dvec3_of(c.base), apex = base + glm::normalize(dvec3_of(c.axis)) * height;
  return {base, apex, base_radius, std::max(0.0, base_radius + slope * height), c.material, c.number};
}

// ---- How far a point is, exactly (engine/query/exact_distance.h).

namespace {

// The segment that makes the cone when it is turned about the axis.
template <class N>
N distance(const dvec3& point, const layout::Cone& c) {
  const Vec<N> axis = vec<N>(c.axis);
  const FromAxis<N> from = from_axis(vec<N>(point), vec<N>(c.base), axis);
  const N r0(c.base_radius), slope(c.slope);
  N end(c.height);
  if (r0 + slope * end < 0) end = -r0 / slope;
  const N length = root(N(dot(axis, axis)));
  const Vec<N> p{from.height, from.away, N(0)}, a{N(0), r0, N(0)},
      b{N(end * length), N(r0 + slope * end), N(0)};
  return root(square_to_segment(p, a, b));
}

}  // namespace

KDRAY_DEFINE_DISTANCES(Cone)

}  // namespace kdray::test

// ---- In exact arithmetic, and hostile ones (stress/exact.h, stress/self_hits.h).
namespace kdray::stress {

namespace {

// Carried on at both ends by this share of its height.
std::vector<Exact> roots_of(const Exact3& o, const Exact3& d, const layout::Cone& cone,
                            double past_the_ends) {
  const Exact3 f = minus(o, exactly(cone.base)), axis = exactly(cone.axis);
  const Exact length2 = dot(axis, axis), fs = dot(f, axis) / length2, ds = dot(d, axis) / length2;
  const Exact r = cone.base_radius + cone.slope * fs, dr = cone.slope * ds;
  std::vector<Exact> found;
  for (const Exact& t :
       quadratic(dot(d, d) - ds * ds * length2 - dr * dr, dot(f, d) - fs * ds * length2 - r * dr,
                 dot(f, f) - fs * fs * length2 - r * r)) {
    const Exact s = fs + t * ds;
    const Exact more = past_the_ends * cone.height;
    const bool within = s >= -more && s <= cone.height + more;
    if (within && sgn(Exact(r + t * dr)) >= 0) found.push_back(t);
  }
  return found;
}

}  // namespace

std::vector<Exact> roots(const Exact3& o, const Exact3& d, const layout::Cone& cone) {
  return roots_of(o, d, cone, 0);
}

double distance(const Exact3& p, const layout::Cone& cone) {
  const Exact3 f = minus(p, exactly(cone.base)), axis = exactly(cone.axis);
  const Exact length2 = dot(axis, axis), s = dot(f, axis) / length2;
  const Exact across2 = dot(f, f) - s * s * length2;
  const Exact across = sgn(across2) > 0 ? Exact(sqrt(across2)) : Exact(0);
  const double slope = cone.slope;
  return Exact(across - cone.base_radius - cone.slope * s).get_d() / std::sqrt(1 + slope * slope);
}

namespace {

// Pointed, truncated, cylinders and cones that are all but flat.
scene::Scene cones(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const double r = static_cast<float>(random.log_uniform(1e-4, 1e4)),
                 height = r * random.log_uniform(1e-2, 1e2);
    const double apex = i % 3 == 0 ? 0 : (i % 3 == 1 ? r : static_cast<float>(r * random.uniform()));
    const dvec3 base(vec3(random.log_uniform(1e-4, 1e6) * random.direction()));
    const dvec3 axis = random.below(4) == 0 ? dvec3(0, 0, 1) : random.direction();
    const dvec3 top(vec3(base + height * axis));
    if (glm::length(top - base) < 0.5 * height) continue;  // drowned by rounding
    s.cones.push_back({base, top, r, apex, 0, s.primitive_count()});
  }
  return s;
}

}  // namespace

std::vector<Family> families_of(primitives::ConeKind) {
  return {{"cones, radius 1e-4 to 1e4, to 1e6 off", cones, 0.15}};
}

Spot spot_on(const layout::Cone& c, Random& random) {
  const dvec3 axis = point3(c.axis), radial = tangent_to(axis, random);
  const double slope = c.slope, s = random.uniform() * c.height, r = c.base_radius + slope * s;
  return {point3(c.base) + s * axis + r * radial, glm::normalize(radial - slope * axis),
          std::max<double>(r, 1e-3 * c.height)};
}

float radius_at(const layout::Cone& c, const dvec3& point) {
  const double along = glm::dot(point - point3(c.base), point3(c.axis));
  return static_cast<float>(c.base_radius + c.slope * std::clamp<double>(along, 0, c.height));
}

// A ray that grazes a cone may meet it next where the exact one is just past an end.
Verdict judge(const layout::Cone& surface, const Ray& ray, const Hit& hit, const Departure& departure) {
  const std::vector<Exact> roots = roots_of(exactly(ray.origin), exactly(ray.direction), surface, 0.02);
  const bool is_at_an_end = std::ranges::any_of(roots, [&](const Exact& root) {
    return root > 0 && std::abs(hit.t - root.get_d()) <= 0.5 * root.get_d();
  });
  return judge_solid(surface, ray, hit, departure, is_at_an_end);
}

}  // namespace kdray::stress
