#include "engine/query/exact_distance.h"

#include <algorithm>
#include <cmath>

namespace kdray::test {

namespace {

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

// The least of the three edges' distances, and of the plane's where the foot lies inside.
template <class N>
N distance(const dvec3& point, const layout::Triangle& t) {
  const Vec<N> p = vec<N>(point), a = vec<N>(t.v[0]), b = vec<N>(t.v[1]), c = vec<N>(t.v[2]);
  N square = square_to_segment(p, a, b);
  square = std::min(square, square_to_segment(p, b, c));
  square = std::min(square, square_to_segment(p, c, a));
  const Vec<N> n = cross(minus(b, a), minus(c, a));
  const auto inside = [&](const Vec<N>& from, const Vec<N>& to) {
    return dot(cross(n, minus(to, from)), minus(p, from)) >= 0;
  };
  if (inside(a, b) && inside(b, c) && inside(c, a)) {
    const N height = dot(n, minus(p, a));
    square = std::min(square, N(height * height / dot(n, n)));
  }
  return root(square);
}

template <class N>
N distance(const dvec3& point, const layout::Sphere& s) {
  const Vec<N> w = minus(vec<N>(point), vec<N>(s.center));
  return size_of(N(root(N(dot(w, w))) - N(s.radius)));
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

template <class N>
N distance(const dvec3& point, const layout::Disc& d) {
  const FromAxis<N> from = from_axis(vec<N>(point), vec<N>(d.center), vec<N>(d.normal));
  const N out = from.away > N(d.radius) ? N(from.away - N(d.radius)) : N(0);
  return root(N(from.height * from.height + out * out));
}

template <class N>
N distance(const dvec3& point, const layout::Torus& t) {
  const FromAxis<N> from = from_axis(vec<N>(point), vec<N>(t.center), vec<N>(t.axis));
  const N out = from.away - N(t.major_radius);
  return size_of(N(root(N(from.height * from.height + out * out)) - N(t.minor_radius)));
}

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

void set_exact_precision() {
  mpf_set_default_prec(1536);
}

#define KDRAY_DISTANCES(NAME, name, names, Struct)                                  \
  Exact exact_distance(const dvec3& point, const layout::Struct& primitive) {       \
    return distance<Exact>(point, primitive);                                       \
  }                                                                                 \
  long double rough_distance(const dvec3& point, const layout::Struct& primitive) { \
    return distance<long double>(point, primitive);                                 \
  }
KDRAY_KINDS(KDRAY_DISTANCES)
#undef KDRAY_DISTANCES

}  // namespace kdray::test
