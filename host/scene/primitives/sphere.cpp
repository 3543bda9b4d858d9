#include "scene/primitives/sphere.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/box.h"
#include "scene/primitives/shape_tools.h"

namespace kdray::primitives {

const char* fault_of(const Sphere& s) {
  const bool good = kdray::is_finite(s.center) && std::isfinite(s.radius) && s.radius > 0;
  return good ? nullptr : "a sphere needs a finite center and a radius above 0";
}

DBox bounds_of(const Sphere& s) {
  return {s.center - s.radius, s.center + s.radius};
}

dvec3 middle_of(const Sphere& s) {
  return s.center;
}

void transform(const Similarity& m, Sphere& s) {
  s.center = m.point(s.center);
  s.radius *= m.factor;
}

SphereGeometry geometry_of(const Sphere& s, const LocalSpace& space, std::uint32_t source) {
  return {vec3(space.local(s.center)), static_cast<float>(space.local_length(s.radius)), source};
}

bool has_area(const SphereGeometry& s) {
  return s.radius > 0;
}

Box bounds_of(const SphereGeometry& s) {
  return box_around(s.center, dvec3(s.radius));
}

layout::Sphere pack(const SphereGeometry& g) {
  layout::Sphere s{};
  set(s.center, g.center);
  s.radius = g.radius;
  return s;
}

Box bounds_of(const layout::Sphere& s) {
  return wide_box_around({s.center[0], s.center[1], s.center[2]}, vec3(s.radius));
}

std::array<float, KDRAY_SPHERE_ROWS - 1> rows_of(const layout::Sphere& s) {
  return {s.center[0], s.center[1], s.center[2], s.radius};
}

dvec3 normal_at(const layout::Sphere& s, const dvec3& point) {
  return safe_normalize(point - dvec3(s.center[0], s.center[1], s.center[2]));
}

// ---- The bounds of a sphere's surface inside a box.
// Along each axis: where the other two coordinates keep to the box, a surface point is at most
// sqrt(r^2 - d^2) from the centre, d the distance to the nearest such pair, and at least sqrt(r^2 -
// D^2), D that to the farthest. The first bounds the ball, the second cuts away what lies wholly
// inside of it; a box that is all inside comes out empty.
// The first as in Arvo's sphere-box test (Graphics Gems, 1990), per axis.

namespace {

constexpr double kRelative = 0x1p-48;  // more than the rounding of a sum of two squares of differences
constexpr double kAbsolute = 0x1p-49;  // more than that of centre +- root, as a part of |centre| + radius

// Squares of the least and the greatest distance along one axis from c to [lo, hi].
void distances(double c, double lo, double hi, double& nearest2, double& farthest2) {
  const double to_lo = lo - c, to_hi = hi - c;
  const double nearest = to_lo > 0 ? to_lo : (to_hi < 0 ? to_hi : 0);
  nearest2 = nearest * nearest;
  farthest2 = std::max(to_lo * to_lo, to_hi * to_hi);
}

}  // namespace

Bounds clip(const SphereGeometry& s, const Bounds& region) {
  const double c[3] = {s.center.x, s.center.y, s.center.z}, r = s.radius;
  double nearest2[3], farthest2[3];
  for (int k = 0; k < 3; ++k) distances(c[k], region.lo[k], region.hi[k], nearest2[k], farthest2[k]);
  Bounds out = region;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double near2 = (nearest2[i] + nearest2[j]) * (1 - kRelative);
    const double far2 = (farthest2[i] + farthest2[j]) * (1 + kRelative);
    const double pad = kAbsolute * (std::abs(c[k]) + r);
    const double outer2 = r * r * (1 + kRelative) - near2;
    if (outer2 < 0) return no_bounds();  // farther away than the radius
    const double outer = std::sqrt(outer2);
    out.lo[k] = std::max(out.lo[k], round_down(c[k] - outer - pad));
    out.hi[k] = std::min(out.hi[k], round_up(c[k] + outer + pad));
    const double inner2 = r * r * (1 - kRelative) - far2;
    if (!(inner2 > 0)) continue;
    // There is no surface strictly between c - inner and c + inner.
    const double inner = std::sqrt(inner2);
    const float gap_lo = round_up(c[k] - inner + pad), gap_hi = round_down(c[k] + inner - pad);
    if (out.lo[k] > gap_lo) out.lo[k] = std::max(out.lo[k], gap_hi);
    if (out.hi[k] < gap_hi) out.hi[k] = std::min(out.hi[k], gap_lo);
  }
  return out;
}

// ---- What is certain about rays and spheres, in double.

dvec3 place_on(const SphereGeometry& s, double share, const dvec3& direction) {
  return dvec3(s.center) + share * s.radius * direction;
}

std::optional<double> sure_hit(const Line& line, const SphereGeometry& s, double margin) {
  const dvec3 way = dvec3(s.center) - line.origin;
  const double length2 = glm::dot(line.direction, line.direction);
  const double nearest = glm::dot(way, line.direction) / length2;
  const double distance = glm::length(way - nearest * line.direction), radius = s.radius;
  if (!(distance < radius - margin)) return {};
  const double half = std::sqrt((radius - distance) * (radius + distance) / length2);
  if (nearest - half > 0) return nearest - half;
  return nearest + half;
}

// Well inside of the outline, near which the distance is off by more than the surface is.
std::optional<double> sure_target(const Line& line, const SphereGeometry& s, double margin) {
  return sure_hit(line, s, margin + 0.01 * s.radius);
}

Quadratic along(const Line& line, const SphereGeometry& s) {
  const dvec3 out = line.origin - dvec3(s.center);
  const double far = glm::length(out), radius = s.radius;
  return {glm::dot(line.direction, line.direction), glm::dot(out, line.direction),
          (far - radius) * (far + radius)};
}

dvec3 outward(const dvec3& point, const SphereGeometry& s) {
  return point - dvec3(s.center);
}

bool meets_again(const Line& line, const SphereGeometry& s, double t, const dvec3& side) {
  return hits_again(along(line, s), t, glm::dot(side, outward(line.origin, s)) > 0);
}

namespace {

// Returns the square of the distance from the centre less that of the radius, to 2^-100 of the larger: a
// point as near to the surface as doubles can be is on the side that it is on.
double power_of(const dvec3& point, const layout::Sphere& s) {
  double sum = -double{s.radius} * s.radius, rest = 0;
  for (int k = 0; k < 3; ++k) {
    const auto [high, low] = exact_sum(point[k], -double{s.center[k]});
    const double square = high * high;
    const auto [added, lost] = exact_sum(sum, square);
    sum = added;
    rest += lost + std::fma(high, high, -square) + 2 * high * low;
  }
  return sum + rest;
}

// `way`: to the centre. The root that is nearer to the origin is found from the other: it has the sign of the
// origin's side, which `power` tells.
template <class Real, class Add>
void cross(const Vec<Real>& way, const Vec<Real>& direction, const Real& radius, const Real& power,
           const Add& add) {
  using std::copysign, std::sqrt, std::min, std::max;
  const Real length2 = dot(direction, direction), nearest = dot(way, direction) / length2;
  const Real distance = length(way - nearest * direction), none = 0;
  if (power > none && !(distance < radius)) return;
  const Real half = sqrt(max(none, (radius - distance) * (radius + distance)) / length2);
  const Real far = nearest + copysign(half, nearest), near = far == none ? none : power / (length2 * far);
  Real t0 = min(near, far), t1 = max(near, far);
  const Real least = std::numeric_limits<double>::min();
  if (power < none) t0 = min(t0, -least), t1 = max(t1, least);
  if (t0 == t1) return;  // it is touched
  add(t0);
  add(t1);
}

}  // namespace

Crossings crossings(const Line& line, const layout::Sphere& s) {
  const dvec3 way = dvec3(s.center[0], s.center[1], s.center[2]) - line.origin;
  Crossings found;
  cross<double>(way, line.direction, s.radius, power_of(line.origin, s), [&](double t) { found.add(t); });
  return found;
}

double distance_to(const layout::Sphere& s, const dvec3& point) {
  return std::abs(glm::distance(point, dvec3(s.center[0], s.center[1], s.center[2])) - s.radius);
}

// ---- In a scene of doubles.

dvec3 normal_at(const Sphere& s, const dvec3& point) {
  const dvec3 out = point - s.center;
  return out == dvec3(0) ? dvec3(0, 0, 1) : safe_normalize(out);
}

Crossings crossings(const Line& line, const Sphere& s) {
  const LineNear near(s.center, line);
  Crossings found;
  if (near.misses(s.radius)) return found;
  const Pair power = dot(near.from(), near.from()) - exact_product(s.radius, s.radius);
  cross<Pair>(-near.from(), near.direction(), s.radius, power,
              [&](const Pair& t) { found.add(near.line_t(t)); });
  return found;
}

NearestOn nearest_on(const Sphere& s, const dvec3& point) {
  return {std::abs(glm::distance(point, s.center) - s.radius), s.center + s.radius * normal_at(s, point)};
}

}  // namespace kdray::primitives
