#include "stress/winding.h"

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kdray::stress {

namespace {

constexpr double kHalfUlp = 0x1p-53;

int sign_of(double x) {
  return (x > 0) - (x < 0);
}

// a - b, and whether that is not rounded.
double difference(double a, double b, bool& exact) {
  const double d = a - b, back = a - d;
  exact &= (a - (d + back)) + (back - b) == 0;
  return d;
}

// The sign of a*b - c*d. Rounding keeps the order of the products, and what it takes from equal ones is
// exact.
int sign_of_difference(double a, double b, double c, double d) {
  const double ab = a * b, cd = c * d;
  return ab != cd ? sign_of(ab - cd) : sign_of(std::fma(a, b, -ab) - std::fma(c, d, -cd));
}

// Which side of the line from a to b the point lies on, as seen along x; 0: on it.
int side_of_line(const dvec3& a, const dvec3& b, const dvec3& p) {
  bool exact = true;
  const double ay = difference(a.y, p.y, exact), az = difference(a.z, p.z, exact);
  const double by = difference(b.y, p.y, exact), bz = difference(b.z, p.z, exact);
  if (exact) return sign_of_difference(ay, bz, az, by);
  const double det = ay * bz - az * by;
  if (std::abs(det) > 4 * kHalfUlp * (std::abs(ay * bz) + std::abs(az * by)) + 1e-300) return sign_of(det);
  const mpq_class y(p.y), z(p.z);
  return sgn(mpq_class((a.y - y) * (b.z - z) - (a.z - z) * (b.y - y)));
}

// The same of the point moved by (e, e^2).
int side_of_line_moved(const dvec3& a, const dvec3& b, const dvec3& p) {
  if (const int side = side_of_line(a, b, p); side != 0) return side;
  if (a.z != b.z) return sign_of(a.z - b.z);
  return sign_of(b.y - a.y);
}

// The sign of the volume of a, b, c and the point.
int side_of_plane(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& p) {
  const dvec3 u = a - p, v = b - p, w = c - p;
  const double vw = v.y * w.z, wv = v.z * w.y, wu = w.y * u.z, uw = w.z * u.y, uv = u.y * v.z, vu = u.z * v.y;
  const double det = u.x * (vw - wv) + v.x * (wu - uw) + w.x * (uv - vu);
  const double most = std::abs(u.x) * (std::abs(vw) + std::abs(wv)) +
                      std::abs(v.x) * (std::abs(wu) + std::abs(uw)) +
                      std::abs(w.x) * (std::abs(uv) + std::abs(vu));
  if (std::abs(det) > 8 * kHalfUlp * most + 1e-290) return sign_of(det);
  const auto minus = [&](const dvec3& q) {
    return std::array<mpq_class, 3>{mpq_class(q.x) - p.x, mpq_class(q.y) - p.y, mpq_class(q.z) - p.z};
  };
  const auto e = minus(a), f = minus(b), g = minus(c);
  return sgn(mpq_class(e[0] * (f[1] * g[2] - f[2] * g[1]) + f[0] * (g[1] * e[2] - g[2] * e[1]) +
                       g[0] * (e[1] * f[2] - e[2] * f[1])));
}

}  // namespace

Winding::Winding(const ClosedShape& shape)
    : shape_(&shape),
      side_(std::clamp(static_cast<int>(std::sqrt(shape.triangles.size())), 1, 256)),
      cells_(static_cast<std::size_t>(side_ * side_)) {
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    const dvec3 &a = shape.corner(t, 0), &b = shape.corner(t, 1), &c = shape.corner(t, 2);
    const dvec3 lo = glm::min(a, glm::min(b, c)), hi = glm::max(a, glm::max(b, c));
    const Cell first = cell_of(lo.y, lo.z), last = cell_of(hi.y, hi.z);
    for (int i = first.i; i <= last.i; ++i)
      for (int j = first.j; j <= last.j; ++j)
        cells_[static_cast<std::size_t>(i * side_ + j)].push_back(static_cast<std::uint32_t>(t));
  }
}

// It grows with y and z, rounding or not, so a point within a triangle's bounds is in one of that one's
// cells.
Winding::Cell Winding::cell_of(double y, double z) const {
  const auto along = [&](double x, double lo, double hi) {
    const double share = hi > lo ? (x - lo) / (hi - lo) : 0;
    return static_cast<int>(std::clamp(share * side_, 0.0, side_ - 1.0));
  };
  return {along(y, shape_->lo.y, shape_->hi.y), along(z, shape_->lo.z, shape_->hi.z)};
}

int Winding::about(const dvec3& p) const {
  if (p.y < shape_->lo.y || p.y > shape_->hi.y || p.z < shape_->lo.z || p.z > shape_->hi.z) return 0;
  const Cell cell = cell_of(p.y, p.z);
  int sum = 0;
  for (const std::uint32_t t : cells_[static_cast<std::size_t>(cell.i * side_ + cell.j)]) {
    const dvec3 &a = shape_->corner(t, 0), &b = shape_->corner(t, 1), &c = shape_->corner(t, 2);
    const int side = side_of_line_moved(a, b, p);
    if (side == 0 || side != side_of_line_moved(b, c, p) || side != side_of_line_moved(c, a, p)) continue;
    // Seen along x the corners run the way that `side` says; the volume has that sign where they are ahead.
    if (side_of_plane(a, b, c, p) == side) sum += side;
  }
  return sum;
}

double winding_by_angles(const ClosedShape& shape, const dvec3& point) {
  double sum = 0;
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    const dvec3 a = shape.corner(t, 0) - point, b = shape.corner(t, 1) - point,
                c = shape.corner(t, 2) - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    sum += 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                          la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace kdray::stress
