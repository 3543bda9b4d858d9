// What    The roots of a polynomial, isolated by those of its derivatives and halved; for numbers of any
//         kind.
// Errors  roots_of: a root that is one of the derivative's too, as of a line that touches, is found or not as
//         rounding has it.
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace kdray::oracle {

template <class N>
using Polynomial = std::vector<N>;  // ascending powers

template <class N>
bool is_below(const Polynomial<N>& p, const N& t) {
  N value = 0;
  for (std::size_t i = p.size(); i-- > 0;) value = value * t + p[i];
  return value < 0;
}

// Those within [lo, hi], ascending: one between each two neighbours among the ends and the roots of the
// derivative, where the signs differ.
template <class N>
std::vector<N> roots_of(const Polynomial<N>& p, const N& lo, const N& hi, int halvings) {
  if (p.size() < 2) return {};
  Polynomial<N> derivative;
  for (std::size_t i = 1; i < p.size(); ++i) derivative.push_back(p[i] * static_cast<double>(i));
  std::vector<N> ends = roots_of(derivative, lo, hi, halvings), found;
  ends.insert(ends.begin(), lo), ends.push_back(hi);
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    N a = ends[i], b = ends[i + 1];
    const bool below = is_below(p, a);
    if (below == is_below(p, b)) continue;
    for (int k = 0; k < halvings; ++k) {
      const N middle = (a + b) / 2;
      (is_below(p, middle) == below ? a : b) = middle;
    }
    found.push_back(a);
  }
  return found;
}

// The real roots of a*t^2 + 2*b*t + c, ascending; returns how many. Citardauq's form, so that neither root
// suffers from cancellation.
inline int roots(double a, double b, double c, double t[2]) {
  if (a == 0) {
    if (b == 0) return 0;
    t[0] = -c / (2 * b);
    return 1;
  }
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return 0;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  t[0] = q / a;
  t[1] = q == 0 ? t[0] : c / q;
  if (t[0] > t[1]) std::swap(t[0], t[1]);
  return 2;
}

// Where a line meets a torus about the origin: (|p|^2 + R^2 - r^2)^2 = 4 R^2 (|p|^2 - z^2), p = g + t*d;
// gg, gd, dd are products of g and d, z and dz their parts along the unit axis.
template <class N>
Polynomial<N> torus_quartic(const N& gg, const N& gd, const N& dd, const N& z, const N& dz, const N& major,
                            const N& minor) {
  const N k = gg + major * major - minor * minor, four = 4 * major * major;
  return {N(k * k - four * (gg - z * z)), N(4 * gd * k - 2 * four * (gd - z * dz)),
          N(2 * dd * k + 4 * gd * gd - four * (dd - dz * dz)), N(4 * dd * gd), N(dd * dd)};
}

}  // namespace kdray::oracle
