// What    Vectors of GMP's floats, or of other numbers, and what exact answers about primitives are made of.
// Source  GMP's mpf.
#pragma once

#include <gmpxx.h>

#include <cmath>

#include "base/vec.h"

namespace kdray::test {

using Exact = mpf_class;

template <class N>
struct Vec {
  N x, y, z;
};

template <class N>
Vec<N> vec(const float (&v)[3]) {
  return {N(v[0]), N(v[1]), N(v[2])};
}
template <class N>
Vec<N> vec(const dvec3& v) {
  return {N(v.x), N(v.y), N(v.z)};
}
template <class N>
Vec<N> minus(const Vec<N>& a, const Vec<N>& b) {
  return {N(a.x - b.x), N(a.y - b.y), N(a.z - b.z)};
}
template <class N>
N dot(const Vec<N>& a, const Vec<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class N>
Vec<N> cross(const Vec<N>& a, const Vec<N>& b) {
  return {N(a.y * b.z - a.z * b.y), N(a.z * b.x - a.x * b.z), N(a.x * b.y - a.y * b.x)};
}
template <class N>
Vec<N> along(const Vec<N>& a, const Vec<N>& d, const N& t) {
  return {N(a.x + d.x * t), N(a.y + d.y * t), N(a.z + d.z * t)};
}
template <class N>
N root(const N& square) {
  using std::sqrt;
  return square > 0 ? N(sqrt(square)) : N(0);
}
template <class N>
N size_of(const N& n) {
  return n < 0 ? N(-n) : n;
}

// The square of the distance from the segment a to b.
template <class N>
N square_to_segment(const Vec<N>& p, const Vec<N>& a, const Vec<N>& b) {
  const Vec<N> e = minus(b, a), w = minus(p, a);
  const N t = dot(w, e), length = dot(e, e);
  if (t <= 0) return dot(w, w);
  if (t >= length) return dot(minus(p, b), minus(p, b));
  const Vec<N> m = cross(w, e);
  return dot(m, m) / length;
}

// Height above the plane through `center` across `axis`, and distance from the axis.
template <class N>
struct FromAxis {
  N height, away;
};
template <class N>
FromAxis<N> from_axis(const Vec<N>& point, const Vec<N>& center, const Vec<N>& axis) {
  const Vec<N> w = minus(point, center);
  const N t = dot(w, axis) / dot(axis, axis), length = root(N(dot(axis, axis)));
  const Vec<N> rest = minus(point, along(center, axis, t));
  return {N(t * length), root(N(dot(rest, rest)))};
}

}  // namespace kdray::test
