// What    Shapes of odd doubles, and where lines cross them, by GMP's floats of 512 bits: from their
//         equations as polynomials of t, whose roots lie between those of the derivative.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "api/rationals.h"
#include "kdray/kdray.h"

namespace kdray::test::doubles {

using Float = mpf_class;
inline Float big(double v) {
  return Float(v, 512);
}
using BigPoint = std::array<Float, 3>;
inline BigPoint big(const Point& p) {
  return {big(p[0]), big(p[1]), big(p[2])};
}
inline BigPoint operator-(const BigPoint& a, const BigPoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Float dot(const BigPoint& a, const BigPoint& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// ---- Polynomials, by the coefficients of 1, t, t^2, ...

using Polynomial = std::vector<Float>;

inline Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  Polynomial c(a.size() + b.size() - 1, big(0.0));
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < b.size(); ++k) c[i + k] += a[i] * b[k];
  return c;
}
// a + f*b
inline Polynomial sum(Polynomial a, const Float& f, const Polynomial& b) {
  a.resize(std::max(a.size(), b.size()), big(0.0));
  for (std::size_t i = 0; i < b.size(); ++i) a[i] += f * b[i];
  return a;
}
inline Float at(const Polynomial& p, const Float& t) {
  Float v = big(0.0);
  for (std::size_t i = p.size(); i-- > 0;) v = v * t + p[i];
  return v;
}

// Where it changes its sign.
inline std::vector<Float> roots(Polynomial p) {
  while (!p.empty() && p.back() == 0) p.pop_back();
  if (p.size() < 2) return {};
  if (p.size() == 2) return {Float(-p[0] / p[1])};
  Polynomial slope(p.begin() + 1, p.end());
  Float largest = big(0.0);
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] *= static_cast<double>(i + 1);
  for (const Float& c : p) largest = std::max<Float>(largest, abs(Float(c / p.back())));
  std::vector<Float> turns{Float(-largest - 1)};  // Cauchy's bound
  for (const Float& t : roots(slope)) turns.push_back(t);
  turns.push_back(largest + 1);
  std::vector<Float> found;
  for (std::size_t i = 0; i + 1 < turns.size(); ++i) {
    Float lo = turns[i], hi = turns[i + 1];
    const int below = sgn(at(p, lo));
    if (below * sgn(at(p, hi)) >= 0) continue;
    for (int step = 0; step < 400; ++step) {
      const Float middle = (lo + hi) / 2;
      (sgn(at(p, middle)) == below ? lo : hi) = middle;
    }
    found.push_back((lo + hi) / 2);
  }
  return found;
}

// ---- Shapes

struct TestShape {
  enum Kind { sphere, cone, disc, torus, capsule } kind;
  Point a, b;     // centre or first end; axis, normal or other end
  double r0, r1;  // radii, as many as it has
};
inline constexpr const char* kShapeNames[] = {"spheres", "cones", "discs", "tori", "capsules"};

// How far a point is from its surface; and whether it is within, of the kinds that have an inside.
struct ShapeDistance {
  Float surface;
  bool inside;
};
inline ShapeDistance distance_to(const TestShape& s, const Point& point) {
  const BigPoint a = big(s.a), b = big(s.b), from = big(point) - a;
  const Float r0 = big(s.r0), r1 = big(s.r1), none = big(0.0);
  const auto clamped = [](const Float& v, const Float& lo, const Float& hi) {
    return v < lo ? lo : v > hi ? hi : v;
  };
  const auto of_solid = [](const Float& beyond) { return ShapeDistance{abs(beyond), beyond < 0}; };
  const BigPoint axis = s.kind == TestShape::cone || s.kind == TestShape::capsule ? b - a : b;
  const Float length = sqrt(dot(axis, axis)), z = length > 0 ? Float(dot(from, axis) / length) : none;
  const Float across2 = dot(from, from) - z * z, across = across2 > 0 ? Float(sqrt(across2)) : none;
  const auto hypotenuse = [](const Float& x, const Float& y) { return Float(sqrt(Float(x * x + y * y))); };
  switch (s.kind) {
    case TestShape::sphere:
      return of_solid(sqrt(dot(from, from)) - r0);
    case TestShape::disc:
      return {hypotenuse(z, across > r0 ? Float(across - r0) : none), false};
    case TestShape::torus:
      return of_solid(hypotenuse(across - r0, z) - r1);
    case TestShape::capsule:
      return of_solid(hypotenuse(across, z - clamped(z, none, length)) - r0);
    default: {  // from (0, r0) to (length, r1), in the half-plane of the point
      const Float rise = r1 - r0;
      const Float share =
          clamped((z * length + (across - r0) * rise) / (length * length + rise * rise), none, big(1.0));
      return {hypotenuse(z - share * length, across - r0 - share * rise), false};
    }
  }
}

struct ShapeCrossing {
  Float t;
  std::uint32_t shape;
  double u;
};

class ShapeLine {
 public:
  ShapeLine(const Point& origin, const Point& direction) : o_(big(origin)), d_(big(direction)) {}

  // In the order of t.
  std::vector<ShapeCrossing> crossings(const std::vector<TestShape>& shapes) const {
    std::vector<ShapeCrossing> found;
    for (std::uint32_t i = 0; i < shapes.size(); ++i) cross(shapes[i], i, found);
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.t < b.t; });
    return found;
  }

 private:
  using Linear = Polynomial;
  Linear along(const BigPoint& from, const BigPoint& axis) const {
    return {dot(o_ - from, axis), dot(d_, axis)};
  }
  Polynomial square(const BigPoint& from) const {
    const BigPoint p = o_ - from;
    return {dot(p, p), 2 * dot(p, d_), dot(d_, d_)};
  }

  void cross(const TestShape& s, std::uint32_t number, std::vector<ShapeCrossing>& found) const {
    const BigPoint a = big(s.a), b = big(s.b);
    const Float r0 = big(s.r0), r1 = big(s.r1), none = big(0.0);
    const auto add = [&](const Polynomial& p, const auto& u_of) {
      for (const Float& t : roots(p))
        if (const double u = u_of(t); u >= 0) found.push_back({t, number, u});
    };
    const auto everywhere = [](const Float&) { return 0.0; };
    switch (s.kind) {
      case TestShape::sphere:
        add(sum(square(a), -1, {r0 * r0}), everywhere);
        return;
      case TestShape::disc: {
        const Linear up = along(a, b);
        if (up[1] == 0) return;
        add(up, [&](const Float& t) {
          const Float away = at(square(a), t);
          return away > r0 * r0 ? -1.0 : Float(sqrt(away) / r0).get_d();
        });
        return;
      }
      case TestShape::cone: {  // |p|^2 - (p*A)^2 / A^2 = (r0 + s*(r1 - r0))^2, s = p*A / A^2
        const BigPoint axis = b - a;
        const Float length2 = dot(axis, axis);
        const Linear up = along(a, axis), s_of = {up[0] / length2, up[1] / length2};
        const Linear radius = sum({r0}, r1 - r0, s_of);
        add(sum(sum(square(a), -1 / length2, up * up), -1, radius * radius), [&](const Float& t) {
          const Float u = at(s_of, t);
          return u < 0 || u > 1 ? -1.0 : u.get_d();
        });
        return;
      }
      case TestShape::torus: {  // (p^2 + R^2 - r^2)^2 = 4 R^2 (p^2 - (p*A)^2 / A^2)
        const Linear up = along(a, b);
        const Polynomial inner = sum(square(a), 1, {r0 * r0 - r1 * r1});
        add(sum(inner * inner, -4 * r0 * r0, sum(square(a), -1 / dot(b, b), up * up)), everywhere);
        return;
      }
      case TestShape::capsule: {  // of the tube, and of each ball what lies beyond it
        const BigPoint axis = b - a;
        const Float length2 = dot(axis, axis);
        const Linear up = along(a, axis);
        if (length2 > 0)
          add(sum(sum(square(a), -1 / length2, up * up), -1, {r0 * r0}), [&](const Float& t) {
            const Float z = at(up, t);
            return z < 0 || z > length2 ? -1.0 : 0.0;
          });
        add(sum(square(a), -1, {r0 * r0}), [&](const Float& t) { return at(up, t) < 0 ? 0.0 : -1.0; });
        add(sum(square(b), -1, {r0 * r0}), [&](const Float& t) {
          const Float z = at(up, t);
          return z > length2 || (length2 == 0 && z >= 0) ? 0.0 : -1.0;
        });
        return;
      }
    }
  }

  BigPoint o_, d_;
};

}  // namespace kdray::test::doubles
