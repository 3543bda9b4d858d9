// What    The bounds of a disc inside a box.
// Shape   Two things bound it beside its own box. A slab of the box along an axis j cuts the disc along two
//         parallel chords, at distances w0 and w1 from its centre; what lies between reaches along another
//         axis k as far as a*w + b*sqrt(r^2 - w^2) does, w in [w0, w1], a and b the axis' parts along and
//         across the direction in which w counts. And a point of the plane whose other two coordinates keep
//         to the box has its own in an interval.
// Errors  All in double. The box is widened by 2^-44 of the largest coordinate or radius before w0 and w1 are
//         computed, which moves them outwards by more than their rounding, and what they give by as much
//         again; products and sums are off by 2^-50 of their terms.

#include <algorithm>
#include <cmath>

#include "base/rounding.h"
#include "scene/primitives/box_around.h"
#include "scene/primitives/disc.h"

namespace kdray::primitives {

namespace {

constexpr double kWiden = 0x1p-44, kRelative = 0x1p-48;

struct Interval {
  double lo, hi;
  void cut(double at_least, double at_most) { lo = std::max(lo, at_least), hi = std::min(hi, at_most); }
  bool empty() const { return !(lo <= hi); }
};

// The largest a*w + b*sqrt(r^2 - w^2) for w in a part of [-r, r]; b >= 0.
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

}  // namespace kdray::primitives
