#include "scene/primitives/capsule.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/box.h"
#include "scene/primitives/shape_tools.h"

namespace kdray::primitives {

const char* fault_of(const Capsule& c) {
  if (!kdray::is_finite(c.start) || !kdray::is_finite(c.end)) return "an end of the capsule is not finite";
  if (!std::isfinite(c.radius) || !(c.radius > 0)) return "a capsule needs a finite radius above 0";
  return nullptr;
}

DBox bounds_of(const Capsule& c) {
  return {glm::min(c.start, c.end) - c.radius, glm::max(c.start, c.end) + c.radius};
}

dvec3 middle_of(const Capsule& c) {
  return 0.5 * c.start + 0.5 * c.end;
}

void transform(const Similarity& m, Capsule& c) {
  c.start = m.point(c.start);
  c.end = m.point(c.end);
  c.radius *= m.factor;
}

// A sphere has any axis.
CapsuleGeometry geometry_of(const Capsule& c, const LocalSpace& space, std::uint32_t source) {
  const dvec3 start = space.local(c.start), end = space.local(c.end), way = end - start;
  return {vec3(0.5 * (start + end)), vec3(way == dvec3(0) ? dvec3(0, 0, 1) : safe_normalize(way)),
          static_cast<float>(0.5 * glm::length(way)), static_cast<float>(space.local_length(c.radius)),
          source};
}

bool has_area(const CapsuleGeometry& c) {
  return c.radius > 0;
}

Box bounds_of(const CapsuleGeometry& c) {
  // 2^-48 covers the roundings of the axis, of its product and of the sum.
  const dvec3 along = glm::abs(glm::normalize(dvec3(c.axis))) * static_cast<double>(c.half_length);
  return box_around(c.center, (along + static_cast<double>(c.radius)) * (1 + 0x1p-48));
}

layout::Capsule pack(const CapsuleGeometry& g) {
  layout::Capsule c{};
  set(c.center, g.center);
  c.half_length = g.half_length;
  set(c.axis, g.axis);
  c.radius = g.radius;
  return c;
}

Box bounds_of(const layout::Capsule& c) {
  const vec3 axis(c.axis[0], c.axis[1], c.axis[2]);
  return wide_box_around({c.center[0], c.center[1], c.center[2]}, c.half_length * glm::abs(axis) + c.radius);
}

std::array<float, KDRAY_CAPSULE_ROWS - 1> rows_of(const layout::Capsule& c) {
  return {c.center[0], c.center[1], c.center[2], c.axis[0], c.axis[1], c.axis[2], c.half_length, c.radius};
}

namespace {

// Everything about the centre, in double.
struct Segment {
  dvec3 center, axis;
  double half, radius;
};
Segment segment_of(const CapsuleGeometry& c) {
  return {dvec3(c.center), glm::normalize(dvec3(c.axis)), c.half_length, c.radius};
}
Segment segment_of(const layout::Capsule& c) {
  return {dvec3(c.center[0], c.center[1], c.center[2]),
          glm::normalize(dvec3(c.axis[0], c.axis[1], c.axis[2])), c.half_length, c.radius};
}

// Returns the way to `from`, relative to the centre, from the nearest place of the segment.
dvec3 from_segment(const Segment& s, const dvec3& from) {
  return from - std::clamp(glm::dot(from, s.axis), -s.half, s.half) * s.axis;
}

// On the segment itself, where there is none, across the axis.
dvec3 normal_of(const Segment& s, const dvec3& point) {
  const dvec3 normal = from_segment(s, point - s.center);
  if (normal != dvec3(0)) return safe_normalize(normal);
  return any_across(s.axis);
}

}  // namespace

dvec3 normal_at(const layout::Capsule& c, const dvec3& point) {
  return normal_of(segment_of(c), point);
}

// ---- The bounds of a capsule inside a box.
// Its surface is that of a cylinder, a union of circles of which a box leaves those of an interval of
// the axis, with the circles at its ends bounding all between; and of two hemispheres, each within its
// own box and, where the other two coordinates keep to the box, no farther along an axis than
// sqrt(r^2 - d^2) from its centre, d the distance to the nearest such pair. A box all of whose corners
// lie inside meets no surface, since the capsule is convex.
// All in double. The box is widened by 2^-44 of the largest coordinate or length, which is more than
// what the places of circles and hemispheres are off by; the result by as much again. Squares carry a
// margin of 2^-48.

namespace {

constexpr double kWiden = 0x1p-44, kRelative = 0x1p-48;

struct Span {
  dvec3 lo, hi;
  bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
};

Span common(const Span& a, const Span& b) {
  return {glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)};
}

Span hull(const Span& a, const Span& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {glm::min(a.lo, b.lo), glm::max(a.hi, b.hi)};
}

constexpr Span kNone{dvec3(1), dvec3(-1)};

// Returns what a box leaves of the cylinder; `reach` is a circle's along x, y and z.
Span tube_within(const Segment& s, const dvec3& reach, const Span& box) {
  double first = -s.half, last = s.half;
  for (int k = 0; k < 3; ++k) {
    const double lo = box.lo[k] - reach[k], hi = box.hi[k] + reach[k], slope = s.axis[k];
    if (slope == 0) {
      if (lo > 0 || hi < 0) return kNone;
      continue;
    }
    first = std::max(first, (slope > 0 ? lo : hi) / slope);
    last = std::min(last, (slope > 0 ? hi : lo) / slope);
  }
  if (!(first <= last)) return kNone;
  const dvec3 a = first * s.axis, b = last * s.axis;
  return common({glm::min(a, b) - reach, glm::max(a, b) + reach}, box);
}

// Returns what a box leaves of the hemisphere at the end of the segment where `out`, a unit vector, points.
Span cap_within(const Segment& s, const dvec3& out, const dvec3& reach, const Span& box) {
  const dvec3 center = s.half * out;
  const double r = s.radius;
  Span left;
  dvec3 nearest2;
  for (int k = 0; k < 3; ++k) {
    left.lo[k] = center[k] - (out[k] <= 0 ? r : reach[k]);
    left.hi[k] = center[k] + (out[k] >= 0 ? r : reach[k]);
    const double off = std::max({box.lo[k] - center[k], center[k] - box.hi[k], 0.0});
    nearest2[k] = off * off;
  }
  for (int k = 0; k < 3; ++k) {
    const double near2 = (nearest2[(k + 1) % 3] + nearest2[(k + 2) % 3]) * (1 - kRelative);
    const double outer2 = r * r * (1 + kRelative) - near2;
    if (outer2 < 0) return kNone;
    const double outer = std::sqrt(outer2);
    left.lo[k] = std::max(left.lo[k], center[k] - outer);
    left.hi[k] = std::min(left.hi[k], center[k] + outer);
  }
  return common(left, box);
}

bool all_corners_inside(const Segment& s, const Span& box, double widen) {
  for (int corner = 0; corner < 8; ++corner) {
    const dvec3 p{(corner & 1 ? box.hi : box.lo).x, (corner & 2 ? box.hi : box.lo).y,
                  (corner & 4 ? box.hi : box.lo).z};
    // A corner far from the capsule has larger rounding errors than the capsule itself.
    if (!(glm::length(from_segment(s, p)) < s.radius - 16 * (widen + kWiden * glm::length(p)))) return false;
  }
  return true;
}

}  // namespace

Bounds clip(const CapsuleGeometry& c, const Bounds& region) {
  const Segment s = segment_of(c);
  const double widen =
      kWiden * std::max({s.half, s.radius, std::abs(s.center.x), std::abs(s.center.y), std::abs(s.center.z)});
  Span box;
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = static_cast<double>(region.lo[k]) - s.center[k] - widen;
    box.hi[k] = static_cast<double>(region.hi[k]) - s.center[k] + widen;
  }
  if (all_corners_inside(s, box, widen)) return no_bounds();
  const dvec3 reach = s.radius * disc_reach(s.axis);
  const Span caps = hull(cap_within(s, s.axis, reach, box), cap_within(s, -s.axis, reach, box));
  const Span left = hull(tube_within(s, reach, box), caps);
  if (left.empty()) return no_bounds();
  Bounds out;
  for (int k = 0; k < 3; ++k) {
    out.lo[k] = round_down(s.center[k] + left.lo[k] - widen);
    out.hi[k] = round_up(s.center[k] + left.hi[k] + widen);
  }
  return intersection(out, region);
}

// ---- What is certain about rays and capsules, in double.

namespace {

// Where a line enters and leaves.
template <class Real>
struct Chord {
  Real near, far;
  bool empty() const { return !(near <= far); }
};
constexpr double kFar = std::numeric_limits<double>::infinity();

template <class Real>
Chord<Real> in_ball(const Vec<Real>& from, const Vec<Real>& direction, const Real& radius) {
  using std::sqrt;
  const Real square = dot(direction, direction), middle = -dot(from, direction) / square;
  const Real away = length(from + middle * direction), left = (radius - away) * (radius + away);
  if (!(left >= Real(0))) return {kFar, -kFar};
  const Real half = sqrt(left / square);
  return {middle - half, middle + half};
}

// From the first place that the line shares with one of the balls about the ends or the cylinder to the last,
// about the place that is nearest to the middle, as the kernels have it. from: the centre.
template <class Real>
Chord<Real> chord_of(const Vec<Real>& from, const Vec<Real>& direction, const Vec<Real>& axis,
                     const Real& half, const Real& radius) {
  using std::abs;
  const Real t_middle = -dot(from, direction) / dot(direction, direction), none = 0;
  const Vec<Real> p = from + t_middle * direction;
  const Chord<Real> below = in_ball<Real>(p + half * axis, direction, radius);
  const Chord<Real> above = in_ball<Real>(p - half * axis, direction, radius);
  const Real z = dot(p, axis), dz = dot(direction, axis);
  const Vec<Real> across = p - z * axis, moving = direction - dz * axis;
  Chord<Real> tube{-kFar, kFar};
  if (moving != Vec<Real>(none))
    tube = in_ball(across, moving, radius);
  else if (length(across) > radius)
    tube = {kFar, -kFar};
  if (dz != none) {
    const Real one = (-half - z) / dz, other = (half - z) / dz;
    tube = {std::max(tube.near, std::min(one, other)), std::min(tube.far, std::max(one, other))};
  } else if (abs(z) > half) {
    tube = {kFar, -kFar};
  }
  if (tube.empty()) tube = {kFar, -kFar};
  return {std::min({tube.near, below.near, above.near}) + t_middle,
          std::max({tube.far, below.far, above.far}) + t_middle};
}

Chord<double> chord_of(const Line& line, const Segment& s) {
  return chord_of<double>(line.origin - s.center, line.direction, s.axis, s.half, s.radius);
}

// How far outside of the surface a point is; below 0 inside.
double height(const dvec3& point, const Segment& s) {
  return glm::length(from_segment(s, point - s.center)) - s.radius;
}

}  // namespace

// All along its profile alike.
dvec3 place_on(const CapsuleGeometry& c, double share, const dvec3& direction) {
  const Segment s = segment_of(c);
  const dvec3 across = direction - glm::dot(direction, s.axis) * s.axis;
  const double length = glm::length(across), along = (2 * share - 1) * (s.half + s.radius);
  const double z = std::clamp(along, -s.half, s.half), up = along - z;
  const double out = std::sqrt(std::max(0.0, (s.radius - up) * (s.radius + up)));
  return s.center + along * s.axis + (length > 0 ? out / length : 0.0) * across;
}

// Well inside of the outline, near which the distance is off by more than the surface is.
std::optional<double> sure_target(const Line& line, const CapsuleGeometry& c, double margin) {
  Segment s = segment_of(c);
  const Chord<double> chord = chord_of(line, s);
  s.radius -= margin + 0.01 * s.radius;
  if (!(s.radius > 0) || chord_of(line, s).empty()) return {};
  return chord.near > 0 ? chord.near : chord.far;
}

bool meets_again(const Line& line, const CapsuleGeometry& c, double t, const dvec3& side) {
  const Segment s = segment_of(c);
  const dvec3 out = from_segment(s, line.origin - s.center);
  const bool is_outside = height(line.origin, s) > 0;
  if (glm::dot(side, out) > 0) return !is_outside || glm::dot(line.direction, out) > 0;
  return is_outside || t < 0.5 * chord_of(line, s).far;
}

// The start is on the side that it is on: inside there is one crossing to each of its sides.
Crossings crossings(const Line& line, const layout::Capsule& c) {
  const Segment s = segment_of(c);
  Chord<double> chord = chord_of(line, s);
  constexpr double kLeast = std::numeric_limits<double>::min();
  Crossings found;
  if (chord.empty()) return found;
  if (height(line.origin, s) < 0)
    chord = {std::min(chord.near, -kLeast), std::max(chord.far, kLeast)};
  else if (chord.near + chord.far > 0)
    chord = {std::max(chord.near, 0.0), std::max(chord.far, 0.0)};
  else
    chord = {std::min(chord.near, 0.0), std::min(chord.far, 0.0)};
  if (chord.near == chord.far) return found;  // it is touched
  found.add(chord.near);
  found.add(chord.far);
  return found;
}

double distance_to(const layout::Capsule& c, const dvec3& point) {
  return std::abs(height(point, segment_of(c)));
}

// ---- In a scene of doubles.

namespace {

Segment segment_of(const Capsule& c) {
  const dvec3 way = c.end - c.start;
  return {0.5 * (c.start + c.end), way == dvec3(0) ? dvec3(0, 0, 1) : safe_normalize(way),
          0.5 * glm::length(way), c.radius};
}

}  // namespace

dvec3 normal_at(const Capsule& c, const dvec3& point) {
  return normal_of(segment_of(c), point);
}

Crossings crossings(const Line& line, const Capsule& c) {
  const Segment about = segment_of(c);
  const LineNear near(about.center, line);
  Crossings found;
  if (near.misses(about.half + c.radius) || near.misses(about.axis, c.radius)) return found;
  Vec<Pair> way, to_center;  // from the middle, to which about.center is rounded
  for (int k = 0; k < 3; ++k) {
    way[k] = exact_sum(c.end[k], -c.start[k]);
    to_center[k] = exact_sum(about.center[k], -c.start[k]) - Pair(0.5) * way[k];
  }
  const Pair whole = length(way), none = 0.0;
  const Vec<Pair> axis = whole == none ? Vec<Pair>(dvec3(0, 0, 1)) : way / whole;
  const Chord<Pair> chord =
      chord_of<Pair>(near.from() + to_center, near.direction(), axis, Pair(0.5) * whole, c.radius);
  if (!(chord.near < chord.far)) return found;  // it is touched, or passed by
  found.add(near.line_t(chord.near));
  found.add(near.line_t(chord.far));
  return found;
}

NearestOn nearest_on(const Capsule& c, const dvec3& point) {
  const Segment s = segment_of(c);
  const dvec3 out = from_segment(s, point - s.center);
  return {std::abs(glm::length(out) - s.radius), point - out + s.radius * normal_of(s, point)};
}

}  // namespace kdray::primitives
