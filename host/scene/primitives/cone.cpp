#include "scene/primitives/cone.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <utility>

#include "base/box.h"
#include "scene/primitives/shape_tools.h"

namespace kdray::primitives {

const char* fault_of(const Cone& c) {
  if (!kdray::is_finite(c.base) || !kdray::is_finite(c.apex)) return "an end of the cone is not finite";
  if (c.base == c.apex) return "base and apex are the same point";
  const auto good = [](double radius) { return std::isfinite(radius) && radius >= 0; };
  if (!good(c.base_radius) || !good(c.apex_radius)) return "a radius of the cone is not finite, or below 0";
  if (c.base_radius + c.apex_radius == 0) return "both radii are 0";
  return nullptr;
}

DBox bounds_of(const Cone& c) {
  const dvec3 reach = disc_reach(c.apex - c.base);
  DBox box{c.base - c.base_radius * reach, c.base + c.base_radius * reach};
  box.grow({c.apex - c.apex_radius * reach, c.apex + c.apex_radius * reach});
  return box;
}

dvec3 middle_of(const Cone& c) {
  return 0.5 * (c.base + c.apex);
}

void transform(const Similarity& m, Cone& c) {
  c.base = m.point(c.base);
  c.apex = m.point(c.apex);
  c.base_radius *= m.factor;
  c.apex_radius *= m.factor;
}

ConeGeometry geometry_of(const Cone& c, const LocalSpace& space, std::uint32_t source) {
  return {vec3(space.local(c.base)), vec3(space.local(c.apex)),
          static_cast<float>(space.local_length(c.base_radius)),
          static_cast<float>(space.local_length(c.apex_radius)), source};
}

bool has_area(const ConeGeometry& c) {
  return c.base != c.apex && (c.base_radius > 0 || c.apex_radius > 0);
}

Box bounds_of(const ConeGeometry& c) {
  // The hull of its two circles. 2^-48 covers the dozen roundings of disc_reach and of its product with the
  // radius.
  const dvec3 reach = disc_reach(dvec3(c.apex) - dvec3(c.base)) * (1 + 0x1p-48);
  Box box = box_around(c.base, reach * static_cast<double>(c.base_radius));
  box.grow(box_around(c.apex, reach * static_cast<double>(c.apex_radius)));
  return box;
}

layout::Cone pack(const ConeGeometry& g) {
  layout::Cone c{};
  const dvec3 axis = dvec3(g.apex) - dvec3(g.base);
  const double height = glm::length(axis);
  set(c.base, g.base);
  set(c.axis, vec3(axis / height));
  c.base_radius = g.base_radius;
  c.height = static_cast<float>(height);
  c.slope = static_cast<float>((double(g.apex_radius) - double(g.base_radius)) / height);
  return c;
}

Box bounds_of(const layout::Cone& c) {
  const vec3 base(c.base[0], c.base[1], c.base[2]), axis(c.axis[0], c.axis[1], c.axis[2]);
  const vec3 across(disc_reach(dvec3(axis)));
  Box box = wide_box_around(base, c.base_radius * across);
  const float apex_radius = c.base_radius + c.slope * c.height + 1e-6f * (c.base_radius + c.height);
  box.grow(wide_box_around(base + c.height * axis, apex_radius * across + vec3(1e-6f * c.height)));
  return box;
}

std::array<float, KDRAY_CONE_ROWS - 1> rows_of(const layout::Cone& c) {
  return {c.base[0], c.base[1], c.base[2], c.axis[0], c.axis[1], c.axis[2], c.base_radius, c.height, c.slope};
}

// ---- The bounds of a truncated cone's lateral surface inside a box.
// The surface is a union of circles, one for each s in [0, 1] along the axis; along a coordinate axis
// circle s covers c(s) -+ r(s)*e, both ends linear in s. The box therefore leaves an interval of s,
// and the bounds of the circles at its two ends contain all between. A box inside the cone's solid
// meets no surface.
// Ends of circles are computed to 2^-47 of the cone's largest coordinate plus radius; twice 2^-45 is
// allowed.

namespace {

constexpr double kWiden = 0x1p-45;

// Upper and lower ends of the first and last circle along a coordinate axis.
struct Ends {
  double lo[2], hi[2];
};

double mix(const double* ends, double s) {
  return ends[0] + s * (ends[1] - ends[0]);
}

// Narrows [s0, s1] to where the linear function with the given ends is <= limit.
void keep_at_most(const double* ends, double limit, double& s0, double& s1) {
  const double d = ends[1] - ends[0];
  if (d == 0) {
    if (ends[0] > limit) s0 = 1, s1 = 0;
    return;
  }
  const double s = (limit - ends[0]) / d;
  if (d > 0) {
    s1 = std::min(s1, s);
  } else {
    s0 = std::max(s0, s);
  }
}

// The solid of one nappe of the infinite cone is convex: when all corners are inside, all of the box is.
bool all_corners_inside(const ConeGeometry& c, const dvec3& axis, const Bounds& box, double widen) {
  const double length2 = glm::dot(axis, axis);
  for (int corner = 0; corner < 8; ++corner) {
    const dvec3 p{(corner & 1 ? box.hi : box.lo)[0], (corner & 2 ? box.hi : box.lo)[1],
                  (corner & 4 ? box.hi : box.lo)[2]};
    const dvec3 f = p - dvec3(c.base);
    const double s = glm::dot(f, axis) / length2;
    const double radius = c.base_radius + s * (static_cast<double>(c.apex_radius) - c.base_radius);
    // A corner far from the cone has larger rounding errors than the cone itself.
    const double margin = 16 * (widen + kWiden * (glm::length(f) + std::abs(radius)));
    if (!(glm::length(f - s * axis) < radius - margin)) return false;
  }
  return true;
}

}  // namespace

Bounds clip(const ConeGeometry& c, const Bounds& region) {
  const dvec3 axis = dvec3(c.apex) - dvec3(c.base);
  const double length = glm::length(axis);
  const double base[3] = {c.base.x, c.base.y, c.base.z}, apex[3] = {c.apex.x, c.apex.y, c.apex.z};
  const double a[3] = {axis.x, axis.y, axis.z};
  double largest = std::max(c.base_radius, c.apex_radius);
  for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(base[k]), std::abs(apex[k])});
  const double widen = 2 * kWiden * largest;
  Ends ends[3];
  double s0 = 0, s1 = 1;
  for (int k = 0; k < 3; ++k) {
    // sqrt(1 - (a_k/length)^2) without its cancellation.
    const double e = length > 0 ? std::hypot(a[(k + 1) % 3], a[(k + 2) % 3]) / length : 1;
    ends[k] = {{base[k] - c.base_radius * e, apex[k] - c.apex_radius * e},
               {base[k] + c.base_radius * e, apex[k] + c.apex_radius * e}};
    keep_at_most(ends[k].lo, region.hi[k] + widen, s0, s1);
    const double negative[2] = {-ends[k].hi[0], -ends[k].hi[1]};
    keep_at_most(negative, -(region.lo[k] - widen), s0, s1);
  }
  if (s0 > s1 || all_corners_inside(c, axis, region, widen)) return no_bounds();
  Bounds out;
  for (int k = 0; k < 3; ++k) {
    out.lo[k] = round_down(std::min(mix(ends[k].lo, s0), mix(ends[k].lo, s1)) - widen);
    out.hi[k] = round_up(std::max(mix(ends[k].hi, s0), mix(ends[k].hi, s1)) + widen);
  }
  return intersection(out, region);
}

// ---- What is certain about rays and cones, in double.

namespace {

// The cone about its axis: radius(s) = base_radius + slope*s at the distance s from the base.
struct Axis {
  dvec3 base, unit;
  double base_radius, slope, height;
};
Axis axis_of(const ConeGeometry& cone) {
  const dvec3 along = dvec3(cone.apex) - dvec3(cone.base);
  const double height = glm::length(along);
  return {dvec3(cone.base), along / height, cone.base_radius,
          (static_cast<double>(cone.apex_radius) - cone.base_radius) / height, height};
}

}  // namespace

dvec3 place_on(const ConeGeometry& c, double share, const dvec3& direction) {
  const double radius = glm::mix(double{c.base_radius}, double{c.apex_radius}, share);
  const dvec3 axis = glm::normalize(dvec3(c.apex) - dvec3(c.base));
  const dvec3 across = glm::cross(axis, direction);
  const double length = glm::length(across);
  return glm::mix(dvec3(c.base), dvec3(c.apex), share) + (length > 0 ? radius / length : 0.0) * across;
}

// Where a line meets a cone is not known so well that its place would be certain.
std::optional<double> sure_target(const Line&, const ConeGeometry&, double) {
  return {};
}

Quadratic along(const Line& line, const ConeGeometry& cone) {
  const Axis axis = axis_of(cone);
  const dvec3 from = line.origin - axis.base;
  const double s = glm::dot(from, axis.unit), ds = glm::dot(line.direction, axis.unit);
  const dvec3 across = from - s * axis.unit, moving = line.direction - ds * axis.unit;
  const double radius = axis.base_radius + axis.slope * s, growing = axis.slope * ds,
               far = glm::length(across);
  return {glm::dot(moving, moving) - growing * growing, glm::dot(across, moving) - radius * growing,
          (far - radius) * (far + radius)};
}

dvec3 outward(const dvec3& point, const ConeGeometry& cone) {
  const Axis axis = axis_of(cone);
  const dvec3 from = point - axis.base;
  const double s = glm::dot(from, axis.unit);
  return (from - s * axis.unit) - axis.slope * (axis.base_radius + axis.slope * s) * axis.unit;
}

bool meets_again(const Line& line, const ConeGeometry& c, double t, const dvec3& side) {
  return hits_again(along(line, c), t, glm::dot(side, outward(line.origin, c)) > 0);
}

namespace {

// With the base as the origin.
template <class Real>
struct Slanted {
  Vec<Real> unit;
  Real base_radius, slope, height;
  bool has_tip = false;  // known to be one: an end's radius is 0
};

Slanted<double> slanted(const layout::Cone& c) {
  return {dvec3(c.axis[0], c.axis[1], c.axis[2]), c.base_radius, c.slope, c.height};
}

template <class Real>
Slanted<Real> slanted(const Cone& c) {
  Vec<Real> axis;
  for (int k = 0; k < 3; ++k) axis[k] = Real(c.apex[k]) - Real(c.base[k]);
  const Real height = length(axis);
  return {axis / height, c.base_radius, (Real(c.apex_radius) - Real(c.base_radius)) / height, height,
          c.base_radius == 0 || c.apex_radius == 0};
}

// Of a*t^2 + 2*b*t + q.
double discriminant(double a, double b, double q, const dvec3&, const dvec3&, double, double) {
  return b * b - a * q;
}
// Of cones that are far wider than high the radius and its growth are as large as they are flat, and their
// product's square cancels out.
Pair discriminant(const Pair&, const Pair&, const Pair&, const Vec<Pair>& across, const Vec<Pair>& moving,
                  const Pair& radius, const Pair& growing) {
  const Vec<Pair> v = radius * moving - growing * across;
  Vec<Pair> area;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    area[k] = across[l] * moving[m] - across[m] * moving[l];
  }
  return dot(v, v) - dot(area, area);
}

// About the place of the line that is nearest to the middle of the axis, so that no term is larger than the
// cone makes it. (0 <= s <= height keeps the other nappe out too: its radius is negative. Beside a tip
// rounding could take a crossing for one of the other nappe: a line that is steeper than the cone crosses
// each of them once, others cross one of them twice.) from: the base.
template <class Real, class Add>
void cross(const Vec<Real>& from, const Vec<Real>& direction, const Slanted<Real>& cone, const Add& add) {
  using std::copysign, std::sqrt;
  const Vec<Real>& unit = cone.unit;
  const Real &height = cone.height, &slope = cone.slope, none = 0;
  const Real middle = -dot(from - Real(0.5) * height * unit, direction) / dot(direction, direction);
  const Vec<Real> g = from + middle * direction;
  const Real s = dot(g, unit), ds = dot(direction, unit);
  const Vec<Real> across = g - s * unit, moving = direction - ds * unit;
  const Real radius = cone.base_radius + slope * s, growing = slope * ds;
  const Real broad = length(moving), far = length(across);
  const Real a = (broad - growing) * (broad + growing), b = dot(across, moving) - radius * growing,
             q = (far - radius) * (far + radius);
  const bool is_steep = cone.has_tip && a < none;
  Real inside = discriminant(a, b, q, across, moving, radius, growing);
  if (is_steep) inside = std::max(inside, none);
  const Real root = sqrt(inside);
  if (!(root > none) && !is_steep) return;
  const Real sum = -(b + copysign(root, b));
  Real roots[2] = {is_steep && sum == none ? none : q / sum, sum / a};
  if (roots[0] > roots[1]) std::swap(roots[0], roots[1]);
  if (is_steep) {
    const bool is_second = growing * roots[0] < growing * roots[1];
    roots[is_second ? 0 : 1] = std::numeric_limits<double>::quiet_NaN();  // the other nappe's
  } else if (cone.has_tip && radius - growing * (b / a) < none) {
    return;
  }
  for (const Real& t : roots) {
    Real at = s + t * ds;
    if (cone.has_tip) at = slope < none ? std::min(at, height) : std::max(at, none);
    if (at >= none && at <= height) add(middle + t, at / height);
  }
}

// In the half-plane of the point, where the surface is a line from the base to the apex: from the base along
// the axis and across it, `s` and `out`, where that line's nearest place is at `along`.
struct InPlane {
  double s, out, along;
  double distance(double slope) const { return std::hypot(s - along, out - slope * along); }
};
InPlane in_plane(const dvec3& from, const Slanted<double>& cone) {
  const double s = glm::dot(from, cone.unit), out = glm::length(from - s * cone.unit) - cone.base_radius,
               slope = cone.slope;
  return {s, out, std::clamp((s + slope * out) / (1 + slope * slope), 0.0, cone.height)};
}

// The radius grows by `slope` along the axis, so the normal leans back by as much.
dvec3 normal_of(const dvec3& from, const Slanted<double>& cone) {
  const dvec3 out = from - glm::dot(from, cone.unit) * cone.unit;
  if (out == dvec3(0)) return cone.slope > 0 ? -cone.unit : cone.unit;  // at the tip
  return glm::normalize(safe_normalize(out) - cone.slope * cone.unit);
}

}  // namespace

dvec3 normal_at(const layout::Cone& c, const dvec3& point) {
  return normal_of(point - dvec3(c.base[0], c.base[1], c.base[2]), slanted(c));
}

Crossings crossings(const Line& line, const layout::Cone& c) {
  Crossings found;
  cross<double>(line.origin - dvec3(c.base[0], c.base[1], c.base[2]), line.direction, slanted(c),
                [&](double t, double u) { found.add(t, u); });
  return found;
}

double distance_to(const layout::Cone& c, const dvec3& point) {
  const Slanted<double> cone = slanted(c);
  return in_plane(point - dvec3(c.base[0], c.base[1], c.base[2]), cone).distance(cone.slope);
}

// ---- In a scene of doubles.

dvec3 normal_at(const Cone& c, const dvec3& point) {
  return normal_of(point - c.base, slanted<double>(c));
}

Crossings crossings(const Line& line, const Cone& c) {
  const dvec3 middle = 0.5 * (c.base + c.apex), axis = c.apex - c.base;
  const double radius = std::max(c.base_radius, c.apex_radius);
  const LineNear near(middle, line);
  Crossings found;
  if (near.misses(std::hypot(0.5 * glm::length(axis), radius)) || near.misses(axis, radius)) return found;
  Vec<Pair> to_middle;
  for (int k = 0; k < 3; ++k) to_middle[k] = exact_sum(middle[k], -c.base[k]);
  cross<Pair>(near.from() + to_middle, near.direction(), slanted<Pair>(c),
              [&](const Pair& t, const Pair& u) { found.add(near.line_t(t), u); });
  return found;
}

NearestOn nearest_on(const Cone& c, const dvec3& point) {
  const Slanted<double> cone = slanted<double>(c);
  const dvec3 from = point - c.base;
  const InPlane at = in_plane(from, cone);
  return {at.distance(cone.slope),
          c.base + at.along * cone.unit +
              (cone.base_radius + cone.slope * at.along) * unit_across(cone.unit, from)};
}

void keep_height(ConeGeometry& c, const Cone& source) {
  if (c.base != c.apex) return;
  const double size =
      std::max({largest_component(dvec3(c.base)), double{c.base_radius}, double{c.apex_radius}});
  c.apex = vec3(dvec3(c.base) + 0x1p-22 * size * safe_normalize(source.apex - source.base));
}

double apart(const Cone& c, const ConeGeometry& of_floats) {
  const dvec3 base(of_floats.base), apex(of_floats.apex);
  const double tilt = glm::distance(glm::normalize(c.apex - c.base), glm::normalize(apex - base));
  return std::max(glm::distance(base, c.base), glm::distance(apex, c.apex)) +
         std::max(std::abs(c.base_radius - of_floats.base_radius),
                  std::abs(c.apex_radius - of_floats.apex_radius)) +
         tilt * std::max(c.base_radius, c.apex_radius);
}

}  // namespace kdray::primitives
