// What    The bounds of a torus inside a box.
// Shape   The circle is cut into arcs, and the tube around each is bounded by the box of the arc, which is
//         that of its chord and its sagitta, made larger by the minor radius. Arcs whose boxes lie across the
//         region's faces are halved, until they are short beside the tube. And a region that lies within the
//         tube, or farther than its radius from the circle, meets no surface: the distance from the circle
//         differs between two points by no more than they are apart.
// Errors  All in double. 2^-44 of the largest coordinate or radius is more than the ends of arcs, halved at
//         most six times, and distances from the circle are off by.

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/rounding.h"
#include "scene/primitives/box_around.h"
#include "scene/primitives/torus.h"

namespace kdray::primitives {

namespace {

constexpr double kWiden = 0x1p-44;
constexpr int kHalvings = 6;

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
  for (int i = 0; i < 4; ++i) add_arc(ring, corners[i], corners[(i + 1) % 4], region, kHalvings, out);
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

}  // namespace kdray::primitives
