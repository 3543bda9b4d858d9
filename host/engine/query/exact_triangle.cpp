#include "engine/query/exact_triangle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/model/predicates.h"

namespace kdray::query {

namespace {

using scene::exact::Expansion;

// Above the rounding of a sum of products of differences, as a share of its terms' sizes: ten roundings or
// fewer each.
constexpr double kSure = 0x1p-48;

int sign_of(double v) {
  return (v > 0) - (v < 0);
}

dvec3 without_tiny(dvec3 v, double least) {
  for (int k = 0; k < 3; ++k)
    if (std::abs(v[k]) < least) v[k] = 0;
  return v;
}

// A coordinate less another, exactly.
Expansion<2> difference(double a, double b) {
  Expansion<2> d;
  d.add(a);
  d.add(-b);
  return d;
}

template <int kCapacity, int kA, int kB>
void add_product(Expansion<kCapacity>& sum, const Expansion<kA>& a, const Expansion<kB>& b, double sign) {
  for (const double part : b) sum.add_product(a, sign * part);
}

// a*b - c*d
template <int kCapacity, int kA>
Expansion<kCapacity> cross(const Expansion<kA>& a, const Expansion<kA>& b, const Expansion<kA>& c,
                           const Expansion<kA>& d) {
  Expansion<kCapacity> sum;
  add_product(sum, a, b, 1);
  add_product(sum, c, d, -1);
  return sum;
}

// The sign of the volume of three corners about a point.
int exact_volume_sign(const float (&v)[3][3], const dvec3& point) {
  Expansion<2> d[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) d[i][k] = difference(v[i][k], point[k]);
  Expansion<192> volume;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    add_product(volume, cross<16>(d[1][l], d[2][m], d[1][m], d[2][l]), d[0][k], 1);
  }
  return volume.sign();
}

}  // namespace

// Of a corner: x and y in the sheared plane times the direction's z, z along it, and what x and y are sums
// of.
struct ExactLine::Place {
  const float (*corner)[3];
  double x, y, x_size, y_size;
};

ExactLine::ExactLine(const dvec3& origin, const dvec3& direction)
    : origin_(without_tiny(origin, 0x1p-140)), direction_(without_tiny(direction, 0x1p-200)), kz_(0) {
  for (int k = 1; k < 3; ++k)
    if (std::abs(direction_[k]) >= std::abs(direction_[kz_])) kz_ = k;
  kx_ = (kz_ + 1) % 3;
  ky_ = (kz_ + 2) % 3;
}

ExactLine::Place ExactLine::place_of(const float (&corner)[3]) const {
  const double z = corner[kz_] - origin_[kz_], dz = direction_[kz_];
  const double x = (corner[kx_] - origin_[kx_]) * dz, shift_x = z * direction_[kx_];
  const double y = (corner[ky_] - origin_[ky_]) * dz, shift_y = z * direction_[ky_];
  return {&corner, x - shift_x, y - shift_y, std::abs(x) + std::abs(shift_x),
          std::abs(y) + std::abs(shift_y)};
}

// Of the edge from P to Q, from which side the moved point sees it: the sign of Qx*Py - Qy*Px, and where that
// is 0 of Qy - Py, and then of Px - Qx.
int ExactLine::side_of(const Place& p, const Place& q) const {
  const double side = q.x * p.y - q.y * p.x, size = q.x_size * p.y_size + q.y_size * p.x_size;
  return std::abs(side) > kSure * size ? sign_of(side) : exact_side_of(*p.corner, *q.corner);
}

int ExactLine::exact_side_of(const float (&p)[3], const float (&q)[3]) const {
  const auto sheared = [&](const float(&corner)[3], int k) {
    Expansion<8> place;
    place.add_product(difference(corner[k], origin_[k]), direction_[kz_]);
    place.add_product(difference(corner[kz_], origin_[kz_]), -direction_[k]);
    return place;
  };
  const Expansion<8> px = sheared(p, kx_), py = sheared(p, ky_), qx = sheared(q, kx_), qy = sheared(q, ky_);
  if (const int side = cross<256>(qx, py, qy, px).sign(); side != 0) return side;
  const auto less = [](const Expansion<8>& a, const Expansion<8>& b) {
    Expansion<16> sum;
    for (const double part : a) sum.add(part);
    for (const double part : b) sum.add(-part);
    return sum.sign();
  };
  const int above = less(qy, py);
  return above != 0 ? above : less(px, qx);
}

// Of a line that crosses the triangle: `facing` is the sign of the product of its direction and the normal.
// Where rounding could have made the sign of t, that is decided exactly, and t lies between the corners.
double ExactLine::distance_to(const Corners& v, int facing_sign) const {
  const auto corner = [&](int i) { return dvec3(v[i][0], v[i][1], v[i][2]); };
  const dvec3 e = corner(1) - corner(0), f = corner(2) - corner(0), a = corner(0) - origin_;
  const dvec3 n = glm::cross(e, f);
  const double volume = glm::dot(n, a), facing = glm::dot(n, direction_);
  double volume_size = 0, facing_size = 0;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    const double part = std::abs(e[l] * f[m]) + std::abs(e[m] * f[l]);
    volume_size += part * std::abs(a[k]);
    facing_size += part * std::abs(direction_[k]);
  }
  if (std::abs(volume) > kSure * volume_size && std::abs(facing) > kSure * facing_size)
    return volume / facing;
  const int sign = exact_volume_sign(v, origin_) * facing_sign;
  if (sign == 0) return 0;
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (int i = 0; i < 3; ++i) {
    const double t = (corner(i)[kz_] - origin_[kz_]) / direction_[kz_];
    lo = std::min(lo, t), hi = std::max(hi, t);
  }
  const double t = facing == 0 ? 0.5 * (lo + hi) : std::clamp(volume / facing, lo, hi);
  constexpr double kLeast = std::numeric_limits<double>::min();
  return sign > 0 ? std::max(t, kLeast) : std::min(t, -kLeast);
}

std::optional<ExactLine::Crossing> ExactLine::crossing(const Corners& v) const {
  const Place a = place_of(v[0]), b = place_of(v[1]), c = place_of(v[2]);
  const int side = side_of(a, b);
  if (side == 0 || side != side_of(b, c) || side != side_of(c, a)) return std::nullopt;
  const auto weight = [](const Place& p, const Place& q) { return std::abs(q.x * p.y - q.y * p.x); };
  const double wa = weight(b, c), wb = weight(c, a), wc = weight(a, b), all = wa + wb + wc;
  const int facing_sign = direction_[kz_] > 0 ? -side : side;
  return Crossing{distance_to(v, facing_sign), all > 0 ? wb / all : 1.0 / 3, all > 0 ? wc / all : 1.0 / 3};
}

}  // namespace kdray::query
