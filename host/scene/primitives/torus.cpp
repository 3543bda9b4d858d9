#include "scene/primitives/torus.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/box.h"
#include "scene/primitives/shape_tools.h"

namespace kdray::primitives {

const char* fault_of(const Torus& t) {
  if (!kdray::is_finite(t.center)) return "the center of the torus is not finite";
  if (!kdray::is_finite(t.axis) || t.axis == dvec3(0)) return "a torus needs an axis with a direction";
  if (!std::isfinite(t.major_radius) || !std::isfinite(t.minor_radius) || !(t.minor_radius > 0))
    return "a torus needs finite radii above 0";
  if (!(t.minor_radius < t.major_radius))
    return "the minor_radius of a torus must be less than its major_radius";
  if (t.major_radius > kThinnestTorus * t.minor_radius)
    return "the major_radius of a torus must be at most 4096 times its minor_radius";
  return nullptr;
}

DBox bounds_of(const Torus& t) {
  const dvec3 reach = t.major_radius * disc_reach(t.axis) + t.minor_radius;
  return {t.center - reach, t.center + reach};
}

dvec3 middle_of(const Torus& t) {
  return t.center;
}

void transform(const Similarity& m, Torus& t) {
  t.center = m.point(t.center);
  t.axis = m.direction(t.axis);
  t.major_radius *= m.factor;
  t.minor_radius *= m.factor;
}

TorusGeometry geometry_of(const Torus& t, const LocalSpace& space, std::uint32_t source) {
  return {vec3(space.local(t.center)), vec3(safe_normalize(t.axis)),
          static_cast<float>(space.local_length(t.major_radius)),
          static_cast<float>(space.local_length(t.minor_radius)), source};
}

bool has_area(const TorusGeometry& t) {
  return t.minor_radius > 0;
}

Box bounds_of(const TorusGeometry& t) {
  // 2^-48 covers the dozen roundings of disc_reach, of its product and of the sum.
  const dvec3 circle = disc_reach(dvec3(t.axis)) * static_cast<double>(t.major_radius);
  return box_around(t.center, (circle + static_cast<double>(t.minor_radius)) * (1 + 0x1p-48));
}

layout::Torus pack(const TorusGeometry& g) {
  layout::Torus t{};
  set(t.center, g.center);
  t.major_radius = g.major_radius;
  set(t.axis, g.axis);
  t.minor_radius = g.minor_radius;
  return t;
}

Box bounds_of(const layout::Torus& t) {
  const vec3 axis(t.axis[0], t.axis[1], t.axis[2]);
  const vec3 across(disc_reach(dvec3(axis)));
  return wide_box_around({t.center[0], t.center[1], t.center[2]}, t.major_radius * across + t.minor_radius);
}

std::array<float, KDRAY_TORUS_ROWS - 1> rows_of(const layout::Torus& t) {
  return {t.center[0], t.center[1], t.center[2],    t.axis[0],
          t.axis[1],   t.axis[2],   t.major_radius, t.minor_radius};
}

namespace {

struct Ideal {
  dvec3 center, axis;
  double major, minor;
};
Ideal ideal(const TorusGeometry& t) {
  return {dvec3(t.center), glm::normalize(dvec3(t.axis)), t.major_radius, t.minor_radius};
}
Ideal ideal(const layout::Torus& t) {
  return {dvec3(t.center[0], t.center[1], t.center[2]),
          glm::normalize(dvec3(t.axis[0], t.axis[1], t.axis[2])), t.major_radius, t.minor_radius};
}
Ideal ideal(const Torus& t) {
  return {t.center, glm::normalize(t.axis), t.major_radius, t.minor_radius};
}

// Away from the nearest place of the circle; in the tube's middle, where there is none, along the axis.
dvec3 normal_of(const Ideal& t, const dvec3& point) {
  const dvec3 from = point - t.center;
  const double along = glm::dot(from, t.axis);
  const dvec3 across = from - along * t.axis;
  const double away = glm::length(across), beyond = away - t.major;
  const dvec3 out = away > 0 ? across / away : dvec3(0), normal = beyond * out + along * t.axis;
  return normal == dvec3(0) ? t.axis : glm::normalize(normal);
}

// How far it is from the circle.
double from_circle(const Ideal& t, const dvec3& point) {
  const dvec3 from = point - t.center;
  const double z = glm::dot(from, t.axis), out = glm::length(from - z * t.axis) - t.major;
  return std::hypot(out, z);
}

}  // namespace

dvec3 normal_at(const layout::Torus& t, const dvec3& point) {
  return normal_of(ideal(t), point);
}

// ---- The bounds of a torus inside a box.
// The circle is cut into arcs, and the tube around each is bounded by the box of the arc, which is
// that of its chord and its sagitta, made larger by the minor radius. Arcs whose boxes lie across the
// region's faces are halved, until they are short beside the tube. And a region that lies within the
// tube, or farther than its radius from the circle, meets no surface: the distance from the circle
// differs between two points by no more than they are apart.
// All in double. 2^-44 of the largest coordinate or radius is more than the ends of arcs, halved at
// most six times, and distances from the circle are off by.

namespace {

constexpr double kWiden = 0x1p-44;
constexpr int kArcHalvings = 6;

// Everything about the torus' centre.
struct Ring {
  dvec3 axis;
  double major, minor, widen;
};

struct Span {
  dvec3 lo, hi;
  bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
};

Span common(const Span& a, const Span& b) {
  return {glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)};
}

bool contains(const Span& outer, const Span& inner) {
  return glm::all(glm::lessThanEqual(outer.lo, inner.lo)) && glm::all(glm::lessThanEqual(inner.hi, outer.hi));
}

void grow(Span& span, const Span& by) {
  span = {glm::min(span.lo, by.lo), glm::max(span.hi, by.hi)};
}

// Adds to `out` what the region leaves of the tube around the arc from a to b, which is shorter than half of
// the circle.
void add_arc(const Ring& ring, const dvec3& a, const dvec3& b, const Span& region, int halvings, Span& out) {
  const dvec3 middle = 0.5 * (a + b);
  const double height = glm::length(middle), sagitta = ring.major - height;
  const double reach = sagitta + ring.minor + ring.widen;
  const Span tube{glm::min(a, b) - reach, glm::max(a, b) + reach}, left = common(tube, region);
  if (left.empty() || contains(out, left)) return;
  if (halvings == 0 || contains(region, tube) || glm::length(b - a) < 0.25 * ring.minor) {
    grow(out, left);
    return;
  }
  const dvec3 halved = middle * (ring.major / height);
  add_arc(ring, a, halved, region, halvings - 1, out);
  add_arc(ring, halved, b, region, halvings - 1, out);
}

double from_circle(const Ring& ring, const dvec3& p) {
  const double along = glm::dot(p, ring.axis), across = glm::length(p - along * ring.axis);
  return std::hypot(across - ring.major, along);
}

bool misses_tube(const Ring& ring, const Span& region) {
  const double distance = from_circle(ring, 0.5 * (region.lo + region.hi));
  const double around = 0.5 * glm::length(region.hi - region.lo) * (1 + 0x1p-48) + ring.widen;
  return distance + around < ring.minor || distance - around > ring.minor;
}

// Corners of a square, and so quarters, in the circle.
Span tube_within(const Ring& ring, const Span& region) {
  const dvec3 other = std::abs(ring.axis.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
  const dvec3 u = ring.major * glm::normalize(glm::cross(ring.axis, other)), v = glm::cross(ring.axis, u);
  const dvec3 corners[] = {u, v, -u, -v};
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Span out{dvec3(kNone), dvec3(-kNone)};
  for (int i = 0; i < 4; ++i) add_arc(ring, corners[i], corners[(i + 1) % 4], region, kArcHalvings, out);
  return out;
}

}  // namespace

Bounds clip(const TorusGeometry& t, const Bounds& region) {
  const dvec3 c(t.center), axis = glm::normalize(dvec3(t.axis));
  const double major = t.major_radius, minor = t.minor_radius;
  const double widen = kWiden * std::max({major, std::abs(c.x), std::abs(c.y), std::abs(c.z)});
  const Ring ring{axis, major, minor, widen};
  const dvec3 reach = disc_reach(axis) * major + minor + widen;
  Span about{-reach, reach};
  for (int k = 0; k < 3; ++k) {
    about.lo[k] = std::max(about.lo[k], static_cast<double>(region.lo[k]) - c[k] - widen);
    about.hi[k] = std::min(about.hi[k], static_cast<double>(region.hi[k]) - c[k] + widen);
  }
  if (about.empty() || misses_tube(ring, about)) return no_bounds();
  const Span left = tube_within(ring, about);
  if (left.empty()) return no_bounds();
  Bounds out;
  for (int k = 0; k < 3; ++k) {
    out.lo[k] = round_down(c[k] + left.lo[k] - widen);
    out.hi[k] = round_up(c[k] + left.hi[k] + widen);
  }
  return intersection(out, region);
}

// ---- What is certain about rays and tori, in double. The turns of the distance along a line are found as
// the kernels find them (kernels/primitives/torus/turns.clh).

namespace {

constexpr int kRootSteps = 240;  // a quarter of them halve

// h, the distance from the torus' circle, along a line.
class Along {
 public:
  Along(const Line& line, const Ideal& t) : major_(t.major) {
    const dvec3 axis = t.axis, from = line.origin - t.center;
    z_ = glm::dot(from, axis), dz_ = glm::dot(line.direction, axis);
    across_ = from - z_ * axis, moving_ = line.direction - dz_ * axis;
    square_ = glm::dot(line.direction, line.direction);
    const double size = 1.01 * (major_ + t.minor), middle = -glm::dot(from, line.direction) / square_;
    const dvec3 nearest = from + middle * line.direction;
    const double half = std::sqrt(std::max(0.0, size * size - glm::dot(nearest, nearest)) / square_);
    lo_ = middle - half, hi_ = middle + half;
    find_turns();
  }

  double height(double t) const {
    const double out = rho(t) - major_, up = z_ + t * dz_;
    return std::sqrt(out * out + up * up);
  }
  // Half of the slope of the square of the height.
  double slope(double t) const {
    const double away = rho(t), out = glm::dot(across_ + t * moving_, moving_);
    return (away > 0 ? (away - major_) * out / away : 0) + (z_ + t * dz_) * dz_;
  }

  // Where the line enters and leaves the sphere around the torus; the two valleys, and the hill between them.
  // A valley may lie at the hill, where there is but one.
  double lo() const { return lo_; }
  double hi() const { return hi_; }
  double left() const { return left_; }
  double hill() const { return hill_; }
  double right() const { return right_; }

  // Between lo and hi, on the way down (up: -1) or up, where it comes to `height`; lo or hi where it doesn't.
  double crossing(double lo, double hi, double up, double at) const {
    return root(lo, hi, [&](double t) { return up * (height(t) - at); });
  }

 private:
  double rho(double t) const { return glm::length(across_ + t * moving_); }

  // Where f, below 0 at lo, is so no longer, to the last bit: by secants, of which an end that stays counts
  // half (the Illinois method), and halvings between them.
  template <class Function>
  static double root(double lo, double hi, const Function& f) {
    double at_lo = f(lo), at_hi = f(hi);
    bool was_below = false;
    for (int i = 0; i < kRootSteps; ++i) {
      const double middle = 0.5 * (lo + hi), secant = lo + (hi - lo) * (at_lo / (at_lo - at_hi));
      const double t = i % 4 < 3 && secant > lo && secant < hi ? secant : middle;
      if (!(t > lo && t < hi)) break;
      const double value = f(t);
      const bool below = value < 0;
      const bool stays = i > 0 && below == was_below;
      was_below = below;
      (below ? lo : hi) = t;
      (below ? at_lo : at_hi) = value;
      if (stays) (below ? at_hi : at_lo) *= 0.5;
    }
    return 0.5 * (lo + hi);
  }

  void find_turns() {
    const double ee = glm::dot(moving_, moving_), nearest = -glm::dot(across_, moving_) / ee;
    const dvec3 c = across_ + nearest * moving_;
    const double cc = glm::dot(c, c), away = std::cbrt(major_ * cc * ee / square_);
    const double half = std::sqrt(std::max(0.0, away * away - cc) / ee), least = major_ * ee / square_;
    const bool whole = !(cc < least * least);  // convex all along
    const double first = whole ? hi_ : std::clamp(nearest - half, lo_, hi_);
    const double second = whole ? hi_ : std::clamp(nearest + half, lo_, hi_);
    const auto rises = [&](double t) { return slope(t); };
    left_ = root(lo_, first, rises);
    hill_ = root(first, second, [&](double t) { return -slope(t); });
    right_ = root(second, hi_, rises);
  }

  double major_, z_, dz_, square_;
  dvec3 across_, moving_;
  double lo_, hi_, left_, hill_, right_;
};

}  // namespace

dvec3 place_on(const TorusGeometry& t, double share, const dvec3& direction) {
  const dvec3 axis = glm::normalize(dvec3(t.axis)), across = direction - glm::dot(direction, axis) * axis;
  const double length = glm::length(across), angle = 2 * std::numbers::pi * share;
  const dvec3 out = length > 0 ? across / length : dvec3(0);
  const double major = t.major_radius, minor = t.minor_radius;
  return dvec3(t.center) + (major + minor * std::cos(angle)) * out + minor * std::sin(angle) * axis;
}

// Away from the nearest place of the circle.
dvec3 outward(const dvec3& point, const TorusGeometry& t) {
  const dvec3 axis = glm::normalize(dvec3(t.axis)), from = point - dvec3(t.center);
  const dvec3 across = from - glm::dot(from, axis) * axis;
  return from - static_cast<double>(t.major_radius) * safe_normalize(across);
}

// Through a valley well below the surface, near which the distance is off by more than the surface is.
std::optional<double> sure_target(const Line& line, const TorusGeometry& t, double margin) {
  const Along along(line, ideal(t));
  const double minor = t.minor_radius, deep = 0.99 * minor - margin, clear = 1.01 * minor + margin;
  const bool from_left = along.height(along.left()) < clear;
  const double valley = from_left ? along.left() : along.right();
  const double top = from_left ? along.lo() : along.hill();
  if (!(along.height(valley) < deep) || !(along.height(top) > clear) || !(top > 0)) return {};
  return along.crossing(top, valley, -1, minor);
}

// A ray that has left the torus may come back on its way down, or once it comes as near as rounding reaches
// behind a hill. One that has gone into it may come out where a hill is as near as that.
bool meets_again(const Line& line, const TorusGeometry& t, double at, const dvec3& side) {
  const Along along(line, ideal(t));
  const double minor = t.minor_radius, hill = along.hill();
  const double reach = 0x1p-17 * (t.major_radius + minor + glm::length(line.origin)), deep = minor - reach;
  const bool outside = glm::dot(side, outward(line.origin, t)) > 0;
  if (outside != (along.height(0) > minor)) return true;
  if (outside) {
    if (along.slope(0) < 0) return false;
    const double clear = minor + reach;
    if (!(hill > 0 && along.height(along.right()) < clear)) return true;
    return at < 0.5 * along.crossing(hill, along.right(), -1, clear);
  }
  const bool over_hill = hill > 0 && along.height(hill) > deep;
  const double exit = over_hill ? along.crossing(std::max(0.0, along.left()), hill, 1, deep)
                                : along.crossing(std::max(0.0, along.right()), along.hi(), 1, minor);
  return at < 0.5 * exit;
}

namespace {

// Down through the surface before each valley that is below it, and up behind it. Where the line has one
// valley, the hill and the other lie at its end.
Crossings crossings_of(const Line& line, const Ideal& t) {
  const Along along(line, t);
  const auto is_below = [&](double at) { return along.height(at) < t.minor; };
  Crossings found;
  if (!(along.lo() < along.hi())) return found;
  const double turns[] = {along.lo(), along.left(), along.hill(), along.right(), along.hi()};
  for (int i = 0; i < 4; ++i)
    if (is_below(turns[i]) != is_below(turns[i + 1]))
      found.add(along.crossing(turns[i], turns[i + 1], is_below(turns[i]) ? 1 : -1, t.minor));
  return found;
}

}  // namespace

Crossings crossings(const Line& line, const layout::Torus& t) {
  return crossings_of(line, ideal(t));
}

double distance_to(const layout::Torus& t, const dvec3& point) {
  return std::abs(from_circle(ideal(t), point) - t.minor_radius);
}

// ---- In a scene of doubles.

dvec3 normal_at(const Torus& t, const dvec3& point) {
  return normal_of(ideal(t), point);
}

namespace {

// Two steps of Newton's for (p^2 + R^2 - r^2)^2 = 4*R^2*(p^2 - (p*axis)^2), whose value is found in pairs.
// Where the line all but touches the torus there, t stays.
Pair improved(double first, const LineNear& line, const Torus& torus) {
  const Vec<Pair> axis(torus.axis);
  const dvec3 direction(line.direction()), unit = glm::normalize(torus.axis);
  const Pair major2 = exact_product(torus.major_radius, torus.major_radius),
             minor2 = exact_product(torus.minor_radius, torus.minor_radius);
  Pair t = first;
  for (int step = 0; step < 2; ++step) {
    const Vec<Pair> p = line.from() + t * line.direction();
    const Pair square = dot(p, p), inner = square + major2 - minor2, up = dot(p, axis);
    const Pair value = inner * inner - Pair(4) * major2 * (square - up * up / dot(axis, axis));
    const dvec3 at(p);
    const double forward = glm::dot(at, direction),
                 slope = 4 * forward * double(inner) -
                         8 * double(major2) * (forward - glm::dot(at, unit) * glm::dot(direction, unit));
    const double by = double(value) / slope;
    if (!(std::abs(by) * glm::length(direction) < 0x1p-30 * torus.minor_radius)) return first;
    t = t - by;
  }
  return t;
}

}  // namespace

Crossings crossings(const Line& line, const Torus& t) {
  const LineNear near(t.center, line);
  Crossings found;
  if (near.misses(t.major_radius + t.minor_radius)) return found;
  Ideal about = ideal(t);
  about.center = dvec3(0);
  for (const auto& at : crossings_of({dvec3(near.from()), line.direction}, about))
    found.add(near.line_t(improved(at.t, near, t)));
  return found;
}

NearestOn nearest_on(const Torus& t, const dvec3& point) {
  const Ideal torus = ideal(t);
  const dvec3 on_circle = t.center + torus.major * unit_across(torus.axis, point - t.center);
  const dvec3 way = point - on_circle;
  const dvec3 normal = way == dvec3(0) ? torus.axis : safe_normalize(way);
  return {std::abs(from_circle(torus, point) - torus.minor), on_circle + torus.minor * normal};
}

}  // namespace kdray::primitives
