#include "scene/primitives/cone.h"

#include <algorithm>
#include <cmath>
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

// The radius grows by `slope` along the axis, so the normal leans back by as much.
dvec3 normal_at(const layout::Cone& c, const dvec3& point) {
  const dvec3 axis(c.axis[0], c.axis[1], c.axis[2]);
  const dvec3 from = point - dvec3(c.base[0], c.base[1], c.base[2]);
  const dvec3 out = from - glm::dot(from, axis) * axis;
  if (out == dvec3(0)) return c.slope > 0 ? -axis : axis;  // at the tip
  return glm::normalize(safe_normalize(out) - static_cast<double>(c.slope) * axis);
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

// About the place of the line that is nearest to the middle of the axis, so that no term is larger than the
// cone makes it. (0 <= s <= height keeps the other nappe out too: its radius is negative.)
Crossings crossings(const Line& line, const layout::Cone& c) {
  const dvec3 unit(c.axis[0], c.axis[1], c.axis[2]);
  const dvec3 from = line.origin - dvec3(c.base[0], c.base[1], c.base[2]);
  const double height = c.height, slope = c.slope;
  const double middle =
      -glm::dot(from - 0.5 * height * unit, line.direction) / glm::dot(line.direction, line.direction);
  const dvec3 g = from + middle * line.direction;
  const double s = glm::dot(g, unit), ds = glm::dot(line.direction, unit);
  const dvec3 across = g - s * unit, moving = line.direction - ds * unit;
  const double radius = c.base_radius + slope * s, growing = slope * ds;
  const double length = glm::length(moving), far = glm::length(across);
  const double a = (length - growing) * (length + growing), b = glm::dot(across, moving) - radius * growing,
               q = (far - radius) * (far + radius);
  Crossings found;
  const double root = std::sqrt(b * b - a * q);
  if (!(root > 0)) return found;
  const double sum = -(b + std::copysign(root, b));
  double roots[2] = {q / sum, sum / a};
  if (roots[0] > roots[1]) std::swap(roots[0], roots[1]);
  for (const double t : roots) {
    const double at = s + t * ds;
    if (at >= 0 && at <= height) found.add(middle + t, at / height);
  }
  return found;
}

// In the half-plane of the point, where the surface is a line from the base to the apex.
double distance_to(const layout::Cone& c, const dvec3& point) {
  const dvec3 unit(c.axis[0], c.axis[1], c.axis[2]);
  const dvec3 from = point - dvec3(c.base[0], c.base[1], c.base[2]);
  const double s = glm::dot(from, unit), out = glm::length(from - s * unit) - c.base_radius;
  const double slope = c.slope,
               along = std::clamp((s + slope * out) / (1 + slope * slope), 0.0, double{c.height});
  return std::hypot(s - along, out - slope * along);
}

}  // namespace kdray::primitives
