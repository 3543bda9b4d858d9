// Capsules in tests: by the textbook in double, random ones, in exact arithmetic, and hostile ones.
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

std::optional<Shape> shape_of(const scene::Scene&, const scene::Capsule& c, DBox& box) {
  for (const dvec3& end : {c.start, c.end}) box.grow(end - c.radius), box.grow(end + c.radius);
  return Shape{.a = c.start, .b = c.end, .r0 = c.radius};
}

// The roots of each of the three surfaces, where they are the capsule's: of a sphere those past its end, of
// the cylinder those between the ends.
Hit intersect(primitives::CapsuleKind, const Shape& s, const Ray& ray, double grow) {
  const double radius = s.r0 + grow;
  if (radius <= 0) return {};
  const dvec3 d = ray.direction, axis = s.b - s.a;
  const double length2 = glm::dot(axis, axis);
  std::vector<double> all;
  const auto add = [&](double a, double b, double c, const dvec3& from, auto counts) {
    double t[2];
    const int n = roots(a, b, c, t);
    for (int i = 0; i < n; ++i)
      if (counts(glm::dot(from + t[i] * d, axis))) all.push_back(t[i]);
  };
  const dvec3 from_a = ray.origin - s.a, from_b = ray.origin - s.b;
  const double square = radius * radius;
  add(glm::dot(d, d), glm::dot(from_a, d), glm::dot(from_a, from_a) - square, from_a,
      [](double along) { return along <= 0; });
  add(glm::dot(d, d), glm::dot(from_b, d), glm::dot(from_b, from_b) - square, from_b,
      [](double along) { return along > 0; });
  if (length2 > 0) {
    const dvec3 across = from_a - glm::dot(from_a, axis) / length2 * axis,
                moving = d - glm::dot(d, axis) / length2 * axis;
    if (glm::dot(moving, moving) > 0)
      add(glm::dot(moving, moving), glm::dot(across, moving), glm::dot(across, across) - square, from_a,
          [&](double along) { return along > 0 && along <= length2; });
  }
  // The origin lies on the surface itself.
  const auto nearest = std::ranges::min_element(all, {}, [](double t) { return std::abs(t); });
  if (ray.self == s.number && nearest != all.end() && std::abs(*nearest) * glm::length(d) < 1e-6 * s.r0)
    all.erase(nearest);
  std::ranges::sort(all);
  for (const double t : all)
    if (within(t, ray)) return {t, s.number};
  return {};
}

void put_surface(primitives::CapsuleKind, const scene::Scene&, const Shape& s, const Hit&, Surface& out) {
  const dvec3 axis = s.b - s.a, from = out.point - s.a;
  const double length2 = glm::dot(axis, axis);
  const double share = length2 > 0 ? std::clamp(glm::dot(from, axis) / length2, 0.0, 1.0) : 0.0;
  out.outward = glm::normalize(from - share * axis);
}

}  // namespace kdray::oracle

namespace kdray::test {

// ---- Random ones (conformance/samples.h).

// From a sphere to a thin stick.
template <>
void Samples<primitives::CapsuleKind>::add(scene::Scene& s, std::uint32_t material, Draw& random) {
  const dvec3 start = random.in_cube(1);
  const double length = random.below(8) == 0 ? 0 : random.size();
  const dvec3 end = start + length * random.axis_or_any();
  const double radius = random.below(4) == 0 ? 0.01 : random.between(0.03, 0.2);
  s.capsules.push_back({start, end, radius, material, next_number(s)});
}
// Often where the cylinder ends.
template <>
RealPoint Samples<primitives::CapsuleKind>::point(const scene::CapsuleGeometry& c, Draw& random) {
  const RealPoint center(c.center), axis = glm::normalize(RealPoint(c.axis));
  const Real half = c.half_length, radius = c.radius;
  const std::size_t part = random.below(4);
  if (part < 2) {
    const Real along = part == 0 ? half * Real(random.between(-1, 1)) : random.below(2) == 0 ? half : -half;
    return on_circle(center + along * axis, axis, radius, random);
  }
  const RealPoint out = glm::normalize(RealPoint(random.axis_or_any()));
  return center + (glm::dot(out, axis) > 0 ? half : -half) * axis + radius * out;
}
// At the side's middle, where a hemisphere begins, or at its top; along the axis or across it.
template <>
Place Samples<primitives::CapsuleKind>::place(const scene::Scene& s, std::size_t i, Draw& random) {
  const scene::Capsule& c = s.capsules[i];
  const dvec3 axis = c.start == c.end ? random.direction() : glm::normalize(c.end - c.start);
  const auto [u, v] = across(RealPoint(axis));
  const dvec3 out(u), around(v), middle = 0.5 * (c.start + c.end);
  const Place places[] = {{middle + c.radius * out, axis},
                          {middle + c.radius * out, around},
                          {c.end + c.radius * out, axis},
                          {c.start + c.radius * out, around},
                          {c.end + c.radius * axis, out}};
  return places[random.below(5)];
}

// ---- What a struct of the kernels stands for (pictures/stored.h).

scene::Capsule as_told(const layout::Capsule& c) {
  const dvec3 center = dvec3_of(c.center), half = double{c.half_length} * glm::normalize(dvec3_of(c.axis));
  return {center - half, center + half, c.radius, c.material, c.number};
}

// ---- How far a point is, exactly (engine/query/exact_distance.h).

namespace {

// Turned about the axis into a half-plane.
template <class N>
N distance(const dvec3& point, const layout::Capsule& c) {
  const FromAxis<N> from = from_axis(vec<N>(point), vec<N>(c.center), vec<N>(c.axis));
  const N half(c.half_length), height = size_of(from.height);
  const N past = height > half ? N(height - half) : N(0);
  return size_of(N(root(N(from.away * from.away + past * past)) - N(c.radius)));
}

}  // namespace

KDRAY_DEFINE_DISTANCES(Capsule)

}  // namespace kdray::test

// ---- In exact arithmetic, and hostile ones (stress/exact.h, stress/self_hits.h).
namespace kdray::stress {

namespace {

// The ends are at half_length about the centre, along the axis as it is.
Exact3 end_of(const layout::Capsule& c, int sign) {
  const Exact3 n = exactly(c.axis);
  return test::along(exactly(c.center), n, Exact(sign * c.half_length / sqrt(dot(n, n))));
}

}  // namespace

std::vector<Exact> roots(const Exact3& o, const Exact3& d, const layout::Capsule& capsule) {
  const Exact3 n = exactly(capsule.axis);
  const Exact r(capsule.radius), nn = dot(n, n);
  std::vector<Exact> all;
  for (const int sign : {-1, 1}) {
    const Exact3 f = minus(o, end_of(capsule, sign));
    for (const Exact& t : quadratic(dot(d, d), dot(f, d), dot(f, f) - r * r))
      if (sign * dot(test::along(f, d, t), n) > 0) all.push_back(t);
  }
  const Exact3 f = minus(o, exactly(capsule.center));
  const Exact fn = dot(f, n), dn = dot(d, n), half = capsule.half_length * sqrt(nn);
  for (const Exact& t :
       quadratic(dot(d, d) - dn * dn / nn, dot(f, d) - fn * dn / nn, dot(f, f) - fn * fn / nn - r * r)) {
    const Exact along = fn + t * dn;
    if (along >= -half && along <= half) all.push_back(t);
  }
  std::ranges::sort(all);
  return all;
}

double distance(const Exact3& p, const layout::Capsule& capsule) {
  const Exact square = test::square_to_segment(p, end_of(capsule, -1), end_of(capsule, 1));
  return Exact(test::root(square) - capsule.radius).get_d();
}

namespace {

// From spheres to sticks a thousand times as long as they are wide.
scene::Scene capsules(std::uint64_t seed) {
  scene::Scene s = with_material();
  for (int i = 0; i < kPrimitives; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const double radius = static_cast<float>(random.log_uniform(1e-4, 1e4)),
                 length = i % 8 == 0 ? 0 : radius * random.log_uniform(1e-2, 1e3);
    const dvec3 start(vec3(random.log_uniform(1e-4, 1e6) * random.direction()));
    dvec3 axis = random.direction();
    if (i % 4 == 1) axis = dvec3(0), axis[static_cast<int>(random.below(3))] = random.sign();
    s.capsules.push_back({start, start + length * axis, radius, 0, s.primitive_count()});
  }
  return s;
}

}  // namespace

std::vector<Family> families_of(primitives::CapsuleKind) {
  return {{"capsules, radius 1e-4 to 1e4, to 1e6 off", capsules, 0.1}};
}

// On the side or on an end.
Spot spot_on(const layout::Capsule& c, Random& random) {
  const dvec3 axis = glm::normalize(point3(c.axis));
  const double along = 2 * random.uniform() - 1, half = c.half_length, radius = c.radius;
  const bool on_side = random.below(2) == 0;
  dvec3 n = on_side ? tangent_to(axis, random) : random.direction();
  const double z = on_side ? along * half : glm::dot(n, axis) > 0 ? half : -half;
  return {point3(c.center) + z * axis + radius * n, n, radius};
}

float radius_at(const layout::Capsule& c, const dvec3&) {
  return c.radius;
}

Verdict judge(const layout::Capsule& surface, const Ray& ray, const Hit& hit, const Departure& departure) {
  return judge_solid(surface, ray, hit, departure, false);
}

}  // namespace kdray::stress
