// What    For each kind of primitive what the conformance suite cannot make up by itself: random primitives,
//         and points that surely lie on one.
// Shape   Samples<Kind> has add(): appends a random primitive to a scene, in size 0.03 to 1 about a point of
//         the cube of [-1, 1]; point(): a random point of a primitive's surface as the tree sees it, in long
//         double; place(): a place on the i-th of the scene's, preferably an odd one, and a direction in its
//         surface; kKnownSelfHits: how many self-hits `kdray verify` may report; and kIsSureOfTargets:
//         whether it is ever sure that a ray meets one. A kind that lacks one of them does not compile.
#pragma once

#include <cmath>
#include <random>
#include <utility>

#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::test {

using Real = long double;
using RealPoint = glm::vec<3, Real>;

// Draws random numbers.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double between(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(engine_); }
  dvec3 in_cube(double half) {
    const double x = between(-half, half), y = between(-half, half);
    return {x, y, between(-half, half)};
  }
  dvec3 direction() {
    for (;;)
      if (const dvec3 d = in_cube(1); glm::dot(d, d) > 0.01 && glm::dot(d, d) <= 1) return glm::normalize(d);
  }
  // An axis in one case of four: what lies across one takes other branches.
  dvec3 axis_or_any() { return below(4) == 0 ? axis() : direction(); }
  dvec3 axis() {
    dvec3 d(0);
    d[static_cast<int>(below(3))] = below(2) == 0 ? 1 : -1;
    return d;
  }
  double size() { return std::pow(10.0, between(-1.5, 0)); }

 private:
  std::mt19937_64 engine_;
};

// A place on a primitive and a direction in its surface there: along an edge, or a tangent.
struct Place {
  dvec3 point, along;
};

template <class Kind>
struct Samples;

inline std::uint32_t next_number(const scene::Scene& s) {
  return s.primitive_count();
}

// Two vectors at right angles to `axis` and to each other, unit.
inline std::pair<RealPoint, RealPoint> across(const RealPoint& axis) {
  const RealPoint other = std::abs(axis.x) < std::abs(axis.y) ? RealPoint(1, 0, 0) : RealPoint(0, 1, 0);
  const RealPoint u = glm::normalize(glm::cross(axis, other));
  return {u, glm::normalize(glm::cross(axis, u))};
}

inline RealPoint on_circle(const RealPoint& center, const RealPoint& axis, Real radius, Draw& random) {
  const auto [u, v] = across(axis);
  const Real angle = random.between(0, 6.283185307179586);
  return center + radius * (std::cos(angle) * u + std::sin(angle) * v);
}

template <>
struct Samples<primitives::TriangleKind> {
  static constexpr std::uint64_t kKnownSelfHits = 0;
  static constexpr bool kIsSureOfTargets = true;

  static void add(scene::Scene& s, std::uint32_t material, Draw& random) {
    const auto first = static_cast<std::uint32_t>(s.vertices.size());
    const dvec3 middle = random.in_cube(1);
    const double size = random.size();
    for (int i = 0; i < 3; ++i) s.vertices.push_back(middle + size * random.direction());
    scene::Triangle t{.vertex = {first, first + 1, first + 2}};
    t.material = material, t.number = next_number(s);
    s.triangles.push_back(t);
  }
  static RealPoint point(const scene::TriangleGeometry& t, Draw& random) {
    Real u = random.between(0, 1), v = random.between(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    if (random.below(4) == 0) u = 0;
    const RealPoint a(scene::vertex(t, 0)), b(scene::vertex(t, 1)), c(scene::vertex(t, 2));
    return (1 - u - v) * a + u * b + v * c;
  }
  // A corner, the middle of an edge, the middle of all.
  static Place place(const scene::Scene& s, std::size_t i, Draw& random) {
    const auto corner = [&](std::size_t k) { return s.vertices[s.triangles[i].vertex[k % 3]]; };
    const std::size_t k = random.below(3);
    const dvec3 edge = corner(k + 1) - corner(k);
    const dvec3 points[] = {corner(k), corner(k) + 0.5 * edge, (corner(0) + corner(1) + corner(2)) / 3.0};
    return {points[random.below(3)], edge};
  }
};

template <>
struct Samples<primitives::SphereKind> {
  static constexpr std::uint64_t kKnownSelfHits = 0;
  static constexpr bool kIsSureOfTargets = true;

  static void add(scene::Scene& s, std::uint32_t material, Draw& random) {
    const dvec3 center = random.in_cube(1);
    s.spheres.push_back({center, 0.5 * random.size(), material, next_number(s)});
  }
  static RealPoint point(const scene::SphereGeometry& s, Draw& random) {
    return RealPoint(s.center) + Real(s.radius) * glm::normalize(RealPoint(random.axis_or_any()));
  }
  // Where it is farthest along an axis, or anywhere.
  static Place place(const scene::Scene& s, std::size_t i, Draw& random) {
    const scene::Sphere& sphere = s.spheres[i];
    if (random.below(2) == 0) {
      const dvec3 axis = random.axis();
      return {sphere.center + sphere.radius * axis, dvec3(axis.y, axis.z, axis.x)};
    }
    const dvec3 d = random.direction();
    return {sphere.center + sphere.radius * d, glm::cross(d, random.direction())};
  }
};

template <>
struct Samples<primitives::ConeKind> {
  // A known fault: of the rays that leave pointed cones one in some 10^5 meets its cone again, near the tip.
  static constexpr std::uint64_t kKnownSelfHits = 1;
  static constexpr bool kIsSureOfTargets = false;

  static void add(scene::Scene& s, std::uint32_t material, Draw& random) {
    const dvec3 base = random.in_cube(1);
    const double size = random.size(), radius = 0.3 * size;
    const dvec3 apex = base + size * random.axis_or_any();
    const double apex_radius = random.below(3) == 0 ? 0 : random.between(0, radius);
    s.cones.push_back({base, apex, radius, apex_radius, material, next_number(s)});
  }
  static RealPoint point(const scene::ConeGeometry& c, Draw& random) {
    const RealPoint base(c.base), axis = RealPoint(c.apex) - base;
    const Real share = random.between(0, 1);
    const Real radius = c.base_radius + share * (Real(c.apex_radius) - Real(c.base_radius));
    return on_circle(base + share * axis, glm::normalize(axis), radius, random);
  }
  // At the foot, half-way up, at the tip or within the upper rim.
  static Place place(const scene::Scene& s, std::size_t i, Draw& random) {
    const scene::Cone& c = s.cones[i];
    const dvec3 axis = c.apex - c.base, side = glm::normalize(glm::cross(axis, random.direction()));
    const dvec3 foot = c.base + c.base_radius * side, slope = c.apex + c.apex_radius * side - foot;
    const Place places[] = {{foot, slope}, {foot + 0.5 * slope, slope}, {c.apex, axis}};
    return places[random.below(3)];
  }
};

template <>
struct Samples<primitives::DiscKind> {
  static constexpr std::uint64_t kKnownSelfHits = 0;
  static constexpr bool kIsSureOfTargets = true;

  static void add(scene::Scene& s, std::uint32_t material, Draw& random) {
    const dvec3 center = random.in_cube(1);
    const dvec3 normal = random.between(0.1, 3) * random.axis_or_any();
    s.discs.push_back({center, normal, random.size(), material, next_number(s)});
  }
  static RealPoint point(const scene::DiscGeometry& d, Draw& random) {
    const Real radius = d.radius * (random.below(4) == 0 ? 1 : std::sqrt(Real(random.between(0, 1))));
    return on_circle(RealPoint(d.center), glm::normalize(RealPoint(d.normal)), radius, random);
  }
  // The centre, on the rim, or between.
  static Place place(const scene::Scene& s, std::size_t i, Draw& random) {
    const scene::Disc& d = s.discs[i];
    const auto [u, v] = across(glm::normalize(RealPoint(d.normal)));
    const dvec3 out(Real(d.radius) * u), along(Real(d.radius) * v);
    const Place places[] = {{d.center, out}, {d.center + out, along}, {d.center + 0.5 * out, out}};
    return places[random.below(3)];
  }
};

template <>
struct Samples<primitives::TorusKind> {
  static constexpr std::uint64_t kKnownSelfHits = 0;
  static constexpr bool kIsSureOfTargets = true;

  // From one whose hole is all but closed to a thin ring.
  static void add(scene::Scene& s, std::uint32_t material, Draw& random) {
    const dvec3 center = random.in_cube(1);
    const double major = 0.5 * random.size(), share = random.below(4) == 0 ? 0.99 : random.between(0.02, 0.7);
    const dvec3 axis = random.between(0.1, 3) * random.axis_or_any();
    s.tori.push_back({center, axis, major, share * major, material, next_number(s)});
  }
  static RealPoint point(const scene::TorusGeometry& t, Draw& random) {
    const RealPoint center(t.center), axis = glm::normalize(RealPoint(t.axis));
    const RealPoint middle = on_circle(center, axis, t.major_radius, random);
    const RealPoint tangent = glm::normalize(glm::cross(axis, middle - center));
    return on_circle(middle, tangent, t.minor_radius, random);
  }
  // On the outer or the inner equator, or on top, where a plane touches along a circle; along that circle or
  // around the tube.
  static Place place(const scene::Scene& s, std::size_t i, Draw& random) {
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
};

}  // namespace kdray::test
