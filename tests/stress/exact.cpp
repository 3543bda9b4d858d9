#include "stress/exact.h"

#include <algorithm>
#include <cmath>

#include "oracle/polynomial.h"

namespace kdray::stress {

namespace {

Exact dot(const Exact3& a, const Exact3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Exact3 minus(const Exact3& a, const Exact3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Exact3 cross(const Exact3& a, const Exact3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// The roots of a t^2 + 2 b t + c.
std::vector<Exact> quadratic(const Exact& a, const Exact& b, const Exact& c) {
  if (sgn(a) == 0) {
    if (sgn(b) == 0) return {};
    return {Exact(-c / (2 * b))};
  }
  const Exact discriminant = b * b - a * c;
  if (sgn(discriminant) < 0) return {};
  const Exact root = sqrt(discriminant), first = (-b - root) / a, second = (-b + root) / a;
  return first < second ? std::vector<Exact>{first, second} : std::vector<Exact>{second, first};
}

}  // namespace

void set_precision() {
  mpf_set_default_prec(1024);
}

Exact3 exactly(const float (&v)[3]) {
  return {Exact(v[0]), Exact(v[1]), Exact(v[2])};
}

std::vector<Exact> roots(const Exact3& o, const Exact3& d, const layout::Triangle& triangle) {
  const Exact3 a = exactly(triangle.v[0]);
  const Exact3 n = cross(minus(exactly(triangle.v[1]), a), minus(exactly(triangle.v[2]), a));
  const Exact along = dot(d, n);
  if (sgn(along) == 0) return {};
  return {Exact(dot(minus(a, o), n) / along)};
}

std::vector<Exact> roots(const Exact3& o, const Exact3& d, const layout::Sphere& sphere) {
  const Exact3 f = minus(o, exactly(sphere.center));
  const Exact r(sphere.radius);
  return quadratic(dot(d, d), dot(f, d), dot(f, f) - r * r);
}

namespace {

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

std::vector<Exact> roots_past_the_ends(const Exact3& o, const Exact3& d, const layout::Cone& cone,
                                       double share) {
  return roots_of(o, d, cone, share);
}

// Anywhere in the plane: which hits near the rim are hits, rounding decides.
std::vector<Exact> roots(const Exact3& o, const Exact3& d, const layout::Disc& disc) {
  const Exact3 n = exactly(disc.normal);
  const Exact along = dot(d, n);
  if (sgn(along) == 0) return {};
  return {Exact(dot(minus(exactly(disc.center), o), n) / along)};
}

// About the place that is nearest to the centre.
std::vector<Exact> roots(const Exact3& o, const Exact3& d, const layout::Torus& torus) {
  const Exact3 f = minus(o, exactly(torus.center)), n = exactly(torus.axis);
  const Exact a = dot(d, d), middle = -dot(f, d) / a, length = sqrt(dot(n, n));
  const Exact3 g = {f.x + middle * d.x, f.y + middle * d.y, f.z + middle * d.z};
  const Exact major(torus.major_radius), minor(torus.minor_radius);
  const auto quartic = oracle::torus_quartic<Exact>(dot(g, g), dot(g, d), a, dot(g, n) / length,
                                                    dot(d, n) / length, major, minor);
  const Exact reach = 2 * (major + minor) / sqrt(a);
  std::vector<Exact> all = oracle::roots_of<Exact>(quartic, -reach, reach, 100);
  for (Exact& t : all) t += middle;
  return all;
}

double distance(const Exact3& p, const layout::Triangle& triangle) {
  const Exact3 a = exactly(triangle.v[0]);
  const Exact3 n = cross(minus(exactly(triangle.v[1]), a), minus(exactly(triangle.v[2]), a));
  return std::abs(Exact(dot(minus(p, a), n) / sqrt(dot(n, n))).get_d());
}

double distance(const Exact3& p, const layout::Sphere& sphere) {
  const Exact3 f = minus(p, exactly(sphere.center));
  return Exact(sqrt(dot(f, f)) - sphere.radius).get_d();
}

double distance(const Exact3& p, const layout::Cone& cone) {
  const Exact3 f = minus(p, exactly(cone.base)), axis = exactly(cone.axis);
  const Exact length2 = dot(axis, axis), s = dot(f, axis) / length2;
  const Exact across2 = dot(f, f) - s * s * length2;
  const Exact across = sgn(across2) > 0 ? Exact(sqrt(across2)) : Exact(0);
  const double slope = cone.slope;
  return Exact(across - cone.base_radius - cone.slope * s).get_d() / std::sqrt(1 + slope * slope);
}

double distance(const Exact3& p, const layout::Disc& disc) {
  const Exact3 n = exactly(disc.normal);
  return std::abs(Exact(dot(minus(p, exactly(disc.center)), n) / sqrt(dot(n, n))).get_d());
}

double distance(const Exact3& p, const layout::Torus& torus) {
  const Exact3 f = minus(p, exactly(torus.center)), n = exactly(torus.axis);
  const Exact z = dot(f, n) / sqrt(dot(n, n)), across2 = dot(f, f) - z * z;
  const Exact out = (sgn(across2) > 0 ? Exact(sqrt(across2)) : Exact(0)) - torus.major_radius;
  return Exact(sqrt(Exact(out * out + z * z)) - torus.minor_radius).get_d();
}

double ulp(double scale) {
  int exponent = 0;
  std::frexp(scale, &exponent);
  return std::ldexp(1.0, std::max(exponent - 24, -149));
}

double ulps(double approximate, const Exact& exact, double scale) {
  return std::abs(Exact(Exact(approximate) - exact).get_d()) / ulp(scale);
}

}  // namespace kdray::stress
