// What    For each kind of primitive what the conformance suite cannot make up by itself: random primitives,
//         and points that surely lie on one.
// Shape   Samples<Kind> has add(): appends a random primitive to a scene; point(): a random point of a
//         primitive's surface as the tree sees it, in long double; and kKnownSelfHits: how many self-hits
//         `kdray verify` may report. A kind that lacks one of them does not compile.
#pragma once

#include <cmath>
#include <random>
#include <utility>

#include "scene/geometry.h"
#include "scene/scene.h"

namespace kdray::test {

using Real = long double;
using RealPoint = glm::vec<3, Real>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
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
  dvec3 axis_or_any() {
    if (below(4) != 0) return direction();
    dvec3 d(0);
    d[static_cast<int>(below(3))] = below(2) == 0 ? 1 : -1;
    return d;
  }
  double size() { return std::pow(10.0, between(-1.5, 0)); }

 private:
  std::mt19937_64 engine_;
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

inline RealPoint on_circle(const RealPoint& center, const RealPoint& axis, Real radius, Random& random) {
  const auto [u, v] = across(axis);
  const Real angle = random.between(0, 6.283185307179586);
  return center + radius * (std::cos(angle) * u + std::sin(angle) * v);
}

template <>
struct Samples<primitives::TriangleKind> {
  static constexpr std::uint64_t kKnownSelfHits = 0;

  static void add(scene::Scene& s, std::uint32_t material, Random& random) {
    const auto first = static_cast<std::uint32_t>(s.vertices.size());
    const dvec3 middle = random.in_cube(1);
    const double size = random.size();
    for (int i = 0; i < 3; ++i) s.vertices.push_back(middle + size * random.direction());
    scene::Triangle t{.vertex = {first, first + 1, first + 2}};
    t.material = material, t.number = next_number(s);
    s.triangles.push_back(t);
  }
  static RealPoint point(const scene::TriangleGeometry& t, Random& random) {
    Real u = random.between(0, 1), v = random.between(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    if (random.below(4) == 0) u = 0;
    const RealPoint a(scene::vertex(t, 0)), b(scene::vertex(t, 1)), c(scene::vertex(t, 2));
    return (1 - u - v) * a + u * b + v * c;
  }
};

template <>
struct Samples<primitives::SphereKind> {
  static constexpr std::uint64_t kKnownSelfHits = 0;

  static void add(scene::Scene& s, std::uint32_t material, Random& random) {
    const dvec3 center = random.in_cube(1);
    s.spheres.push_back({center, 0.5 * random.size(), material, next_number(s)});
  }
  static RealPoint point(const scene::SphereGeometry& s, Random& random) {
    return RealPoint(s.center) + Real(s.radius) * glm::normalize(RealPoint(random.axis_or_any()));
  }
};

template <>
struct Samples<primitives::ConeKind> {
  // A known fault: of the rays that leave pointed cones one in some 10^5 meets its cone again, near the tip.
  static constexpr std::uint64_t kKnownSelfHits = 1;

  static void add(scene::Scene& s, std::uint32_t material, Random& random) {
    const dvec3 base = random.in_cube(1);
    const double size = random.size(), radius = 0.3 * size;
    const dvec3 apex = base + size * random.axis_or_any();
    const double apex_radius = random.below(3) == 0 ? 0 : random.between(0, radius);
    s.cones.push_back({base, apex, radius, apex_radius, material, next_number(s)});
  }
  static RealPoint point(const scene::ConeGeometry& c, Random& random) {
    const RealPoint base(c.base), axis = RealPoint(c.apex) - base;
    const Real share = random.between(0, 1);
    const Real radius = c.base_radius + share * (Real(c.apex_radius) - Real(c.base_radius));
    return on_circle(base + share * axis, glm::normalize(axis), radius, random);
  }
};

template <>
struct Samples<primitives::DiscKind> {
  static constexpr std::uint64_t kKnownSelfHits = 0;

  static void add(scene::Scene& s, std::uint32_t material, Random& random) {
    const dvec3 center = random.in_cube(1);
    const dvec3 normal = random.between(0.1, 3) * random.axis_or_any();
    s.discs.push_back({center, normal, random.size(), material, next_number(s)});
  }
  static RealPoint point(const scene::DiscGeometry& d, Random& random) {
    const Real radius = d.radius * (random.below(4) == 0 ? 1 : std::sqrt(Real(random.between(0, 1))));
    return on_circle(RealPoint(d.center), glm::normalize(RealPoint(d.normal)), radius, random);
  }
};

}  // namespace kdray::test
