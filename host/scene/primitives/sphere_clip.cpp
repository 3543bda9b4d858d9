// What    The bounds of a sphere's surface inside a box.
// Shape   Along each axis: where the other two coordinates keep to the box, a surface point is at most
//         sqrt(r^2 - d^2) from the centre, d the distance to the nearest such pair, and at least sqrt(r^2 -
//         D^2), D that to the farthest. The first bounds the ball, the second cuts away what lies wholly
//         inside of it; a box that is all inside comes out empty.
// Source  The first as in Arvo's sphere-box test (Graphics Gems, 1990), per axis.

#include <cmath>

#include "base/rounding.h"
#include "scene/primitives/sphere.h"

namespace kdray::primitives {

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

}  // namespace kdray::primitives
