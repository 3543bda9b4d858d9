#include "scene/primitives/disc.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/box.h"
#include "scene/primitives/shape_tools.h"

namespace kdray::primitives {

const char* fault_of(const Disc& d) {
  if (!kdray::is_finite(d.center) || !std::isfinite(d.radius) || !(d.radius > 0))
    return "a disc needs a finite center and a radius above 0";
  const bool has_direction = kdray::is_finite(d.normal) && d.normal != dvec3(0);
  return has_direction ? nullptr : "a disc needs a normal with a direction";
}

DBox bounds_of(const Disc& d) {
  const dvec3 reach = d.radius * disc_reach(d.normal);
  return {d.center - reach, d.center + reach};
}

dvec3 middle_of(const Disc& d) {
  return d.center;
}

void transform(const Similarity& m, Disc& d) {
  d.center = m.point(d.center);
  d.normal = m.direction(d.normal);
  d.radius *= m.factor;
}

DiscGeometry geometry_of(const Disc& d, const LocalSpace& space, std::uint32_t source) {
  return {vec3(space.local(d.center)), vec3(safe_normalize(d.normal)),
          static_cast<float>(space.local_length(d.radius)), source};
}

bool has_area(const DiscGeometry& d) {
  return d.radius > 0;
}

Box bounds_of(const DiscGeometry& d) {
  // 2^-48 covers the dozen roundings of disc_reach and of its product with the radius.
  return box_around(d.center, disc_reach(dvec3(d.normal)) * (static_cast<double>(d.radius) * (1 + 0x1p-48)));
}

layout::Disc pack(const DiscGeometry& g) {
  layout::Disc d{};
  set(d.center, g.center);
  set(d.normal, g.normal);
  d.radius = g.radius;
  return d;
}

Box bounds_of(const layout::Disc& d) {
  const vec3 normal(d.normal[0], d.normal[1], d.normal[2]);
  return wide_box_around({d.center[0], d.center[1], d.center[2]}, d.radius * vec3(disc_reach(dvec3(normal))));
}

std::array<float, KDRAY_DISC_ROWS - 1> rows_of(const layout::Disc& d) {
  return {d.center[0], d.center[1], d.center[2], d.normal[0], d.normal[1], d.normal[2], d.radius};
}

dvec3 normal_at(const layout::Disc& d, const dvec3&) {
  return glm::normalize(dvec3(d.normal[0], d.normal[1], d.normal[2]));
}

// ---- The bounds of a disc inside a box.
// Two things bound it beside its own box. A slab of the box along an axis j cuts the disc along two
// parallel chords, at distances w0 and w1 from its centre; what lies between reaches along another
// axis k as far as a*w + b*sqrt(r^2 - w^2) does, w in [w0, w1], a and b the axis' parts along and
// across the direction in which w counts. And a point of the plane whose other two coordinates keep
// to the box has its own in an interval.
// All in double. The box is widened by 2^-44 of the largest coordinate or radius before w0 and w1 are
// computed, which moves them outwards by more than their rounding, and what they give by as much
// again; products and sums are off by 2^-50 of their terms.

namespace {

constexpr double kWiden = 0x1p-44, kRelative = 0x1p-48;

struct Interval {
  double lo, hi;
  void cut(double at_least, double at_most) { lo = std::max(lo, at_least), hi = std::min(hi, at_most); }
  bool empty() const { return !(lo <= hi); }
};

// Returns the largest a*w + b*sqrt(r^2 - w^2) for w in a part of [-r, r]; b >= 0.
double farthest(double a, double b, const Interval& w, double r) {
  const double length = std::hypot(a, b), best = length > 0 ? r * a / length : 0;
  const double at = std::clamp(best, w.lo, w.hi);
  return a * at + b * std::sqrt(std::max(0.0, (r - at) * (r + at)));
}

// Cuts each coordinate, about the centre, to what the plane leaves of it; n is its unit normal.
void cut_with_plane(const dvec3& n, double widen, Interval (&at)[3]) {
  for (int k = 0; k < 3; ++k) {
    if (n[k] == 0) continue;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const auto [i_lo, i_hi] = std::minmax({n[i] * at[i].lo, n[i] * at[i].hi});
    const auto [j_lo, j_hi] = std::minmax({n[j] * at[j].lo, n[j] * at[j].hi});
    const double size = std::max(std::abs(i_lo), std::abs(i_hi)) + std::max(std::abs(j_lo), std::abs(j_hi));
    const double pad = widen + kRelative * size, inverse = 1 / std::abs(n[k]);
    const double lo = -(i_hi + j_hi) - pad, hi = -(i_lo + j_lo) + pad;
    if (n[k] > 0)
      at[k].cut(lo * inverse - widen, hi * inverse + widen);
    else
      at[k].cut(-hi * inverse - widen, -lo * inverse + widen);
  }
}

}  // namespace

Bounds clip(const DiscGeometry& d, const Bounds& region) {
  const dvec3 n = glm::normalize(dvec3(d.normal)), c(d.center), reach = disc_reach(n);
  const double r = d.radius;
  const double widen = kWiden * std::max({r, std::abs(c.x), std::abs(c.y), std::abs(c.z)});
  Interval box[3], at[3];  // about the centre
  for (int k = 0; k < 3; ++k) {
    box[k] = {region.lo[k] - c[k] - widen, region.hi[k] - c[k] + widen};
    at[k] = box[k];
    at[k].cut(-r * reach[k] - widen, r * reach[k] + widen);
  }
  for (int j = 0; j < 3; ++j) {
    if (!(reach[j] > 0)) continue;
    Interval w{box[j].lo / reach[j], box[j].hi / reach[j]};
    w.cut(-r, r);
    if (w.empty()) return no_bounds();
    for (const int k : {(j + 1) % 3, (j + 2) % 3}) {
      const double along = -n[k] * n[j] / reach[j], across = std::abs(n[3 - j - k]) / reach[j];
      at[k].cut(-farthest(-along, across, w, r) - widen, farthest(along, across, w, r) + widen);
    }
  }
  cut_with_plane(n, widen, at);
  Bounds out;
  for (int k = 0; k < 3; ++k) {
    if (at[k].empty()) return no_bounds();
    out.lo[k] = round_down(c[k] + at[k].lo - widen);
    out.hi[k] = round_up(c[k] + at[k].hi + widen);
  }
  return intersection(out, region);
}

// ---- What is certain about rays and discs, in double.

namespace {

// Returns the sign of a product of vectors; 0 where rounding may have made it.
int sure_sign(const dvec3& a, const dvec3& b) {
  const double product = glm::dot(a, b), size = glm::dot(glm::abs(a), glm::abs(b));
  if (std::abs(product) <= 8 * std::numeric_limits<double>::epsilon() * size) return 0;
  return product > 0 ? 1 : -1;
}

}  // namespace

dvec3 place_on(const DiscGeometry& d, double share, const dvec3& direction) {
  const dvec3 across = glm::cross(dvec3(d.normal), direction);
  const double length = glm::length(across);
  return dvec3(d.center) + (length > 0 ? share * d.radius / length : 0.0) * across;
}

// Steeply, so that the place in the plane is off by no more than 16 margins.
std::optional<double> sure_target(const Line& line, const DiscGeometry& d, double margin) {
  const dvec3 n(d.normal), way = dvec3(d.center) - line.origin;
  const double facing = glm::dot(n, line.direction);
  if (std::abs(facing) < 0x1p-4 * glm::length(n) * glm::length(line.direction)) return {};
  const double t = glm::dot(n, way) / facing;
  if (!(glm::length(t * line.direction - way) < d.radius - 16 * margin)) return {};
  return t;
}

// A ray that has left a disc meets it only where it was sent towards it.
bool meets_again(const Line& line, const DiscGeometry& d, double, const dvec3&) {
  const dvec3 n(d.normal);
  const int side = sure_sign(n, line.origin - dvec3(d.center)), way = sure_sign(n, line.direction);
  return side * way >= 0;
}

Crossings crossings(const Line& line, const layout::Disc& d) {
  const dvec3 n(d.normal[0], d.normal[1], d.normal[2]);
  const dvec3 way = dvec3(d.center[0], d.center[1], d.center[2]) - line.origin;
  Crossings found;
  if (sure_sign(n, line.direction) == 0) return found;
  const double t = glm::dot(n, way) / glm::dot(n, line.direction),
               away = glm::length(t * line.direction - way);
  if (away <= d.radius) found.add(t, away / d.radius);
  return found;
}

namespace {

NearestOn nearest_in(const dvec3& center, const dvec3& normal, double radius, const dvec3& point) {
  const dvec3 n = glm::normalize(normal), from = point - center;
  const double above = glm::dot(from, n);
  const dvec3 across = from - above * n;
  const double out = glm::length(across), beyond = out - radius;
  return {std::hypot(above, std::max(beyond, 0.0)), center + (beyond > 0 ? radius / out : 1.0) * across};
}

}  // namespace

double distance_to(const layout::Disc& d, const dvec3& point) {
  return nearest_in(dvec3(d.center[0], d.center[1], d.center[2]),
                    dvec3(d.normal[0], d.normal[1], d.normal[2]), d.radius, point)
      .distance;
}

// ---- In a scene of doubles.

dvec3 normal_at(const Disc& d, const dvec3&) {
  return safe_normalize(d.normal);
}

// A line in the disc's plane, or so little across it that pairs can't tell, passes it by.
Crossings crossings(const Line& line, const Disc& d) {
  const LineNear near(d.center, line);
  Crossings found;
  if (near.misses(d.radius)) return found;
  const Vec<Pair> n(d.normal);
  const Pair facing = dot(n, near.direction());
  if (!(std::abs(facing.high) > 0x1p-98 * glm::dot(glm::abs(d.normal), glm::abs(line.direction))))
    return found;
  const Pair t = -dot(n, near.from()) / facing, away = length(near.from() + t * near.direction());
  if (away <= Pair(d.radius)) found.add(near.line_t(t), away / d.radius);
  return found;
}

NearestOn nearest_on(const Disc& d, const dvec3& point) {
  return nearest_in(d.center, d.normal, d.radius, point);
}

}  // namespace kdray::primitives
