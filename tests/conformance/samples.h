// What    For each kind of primitive what the conformance suite cannot make up by itself: random primitives,
//         and points that surely lie on one.
// Shape   Samples<Kind>, of which each kind defines all three (tests/primitives/<kind>.cpp). add(): appends a
//         random primitive to a scene, in size 0.03 to 1 about a point of the cube of [-1, 1]; point(): a
//         random point of a primitive's surface as the tree sees it, often on an edge or a rim; place(): a
//         place on the i-th of the scene's, preferably an odd one, and a direction in its surface.
#pragma once

#include <cmath>
#include <random>
#include <type_traits>
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

// A primitive of a kind as the tree has it.
template <class Kind>
using GeometryOf = std::remove_cvref_t<decltype(Kind::of(std::declval<scene::Geometry&>())[0])>;

template <class Kind>
struct Samples {
  static void add(scene::Scene& s, std::uint32_t material, Draw& random);
  static RealPoint point(const GeometryOf<Kind>& primitive, Draw& random);
  static Place place(const scene::Scene& s, std::size_t i, Draw& random);
};

// How many self-hits `kdray verify` may report. A known fault: of the rays that leave pointed cones one in
// some 10^5 meets its cone again, near the tip.
template <class Kind>
inline constexpr std::uint64_t kKnownSelfHits = std::is_same_v<Kind, primitives::ConeKind> ? 1 : 0;
// Whether it is ever sure that a ray meets one.
template <class Kind>
inline constexpr bool kIsSureOfTargets = !std::is_same_v<Kind, primitives::ConeKind>;

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

}  // namespace kdray::test
