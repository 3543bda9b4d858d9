// What    The bounds of a truncated cone's lateral surface inside a box.
// Shape   The surface is a union of circles, one for each s in [0, 1] along the axis; along a coordinate axis
//         circle s covers c(s) -+ r(s)*e, both ends linear in s. The box therefore leaves an interval of s,
//         and the bounds of the circles at its two ends contain all between. A box inside the cone's solid
//         meets no surface.
// Errors  Ends of circles are computed to 2^-47 of the cone's largest coordinate plus radius; twice 2^-45 is
//         allowed.

#include <cmath>

#include "base/rounding.h"
#include "scene/primitives/cone.h"

namespace kdray::primitives {

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

}  // namespace kdray::primitives
