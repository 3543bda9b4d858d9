// What    The square of a point's distance from a triangle, by definition: the least of its edges', and of
//         its plane's where the foot lies inside. In GMP's rationals it is exact, whatever the coordinates;
//         in long double it tells which triangles are worth that.
// Shape   A triangle without area is its edges, and an edge without length is its corners.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <array>

#include "base/vec.h"

namespace kdray::stress {

template <class N>
using Coordinates = std::array<N, 3>;

template <class N>
Coordinates<N> minus(const Coordinates<N>& a, const Coordinates<N>& b) {
  return {N(a[0] - b[0]), N(a[1] - b[1]), N(a[2] - b[2])};
}
template <class N>
N dot(const Coordinates<N>& a, const Coordinates<N>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class N>
Coordinates<N> cross(const Coordinates<N>& a, const Coordinates<N>& b) {
  return {N(a[1] * b[2] - a[2] * b[1]), N(a[2] * b[0] - a[0] * b[2]), N(a[0] * b[1] - a[1] * b[0])};
}

// From the origin, as is the next.
template <class N>
N square_to_segment(const Coordinates<N>& a, const Coordinates<N>& b) {
  const Coordinates<N> e = minus(b, a);
  const N t = -dot(a, e), length = dot(e, e);
  if (t <= 0) return dot(a, a);
  if (t >= length) return dot(b, b);
  const Coordinates<N> m = cross(a, e);
  return dot(m, m) / length;
}

template <class N>
N square_to_triangle(const Coordinates<N>& a, const Coordinates<N>& b, const Coordinates<N>& c) {
  N square = square_to_segment(a, b);
  square = std::min(square, square_to_segment(b, c));
  square = std::min(square, square_to_segment(c, a));
  const Coordinates<N> n = cross(minus(b, a), minus(c, a));
  const N length = dot(n, n);
  if (length == 0) return square;
  const auto inside = [&](const Coordinates<N>& p, const Coordinates<N>& q) {
    return dot(n, cross(p, q)) >= 0;
  };
  if (!inside(a, b) || !inside(b, c) || !inside(c, a)) return square;
  const N height = dot(n, a);
  return std::min(square, N(height * height / length));
}

template <class N>
Coordinates<N> as(const dvec3& v) {
  return {N(v.x), N(v.y), N(v.z)};
}

}  // namespace kdray::stress
