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

// A coordinate less another, and less what rounding left of it, exactly.
Expansion<3> difference(double a, double b, double rest = 0) {
  Expansion<3> d;
  d.add(a);
  d.add(-b);
  if (rest != 0) d.add(-rest);
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

// A triangle's normal times two vectors: from the line's origin to a corner, and the line's direction. t is
// their quotient.
struct ExactQuotient {
  Expansion<432> volume;
  Expansion<144> facing;

  ExactQuotient(const ExactLine::Corners& v, const dvec3& origin, const dvec3& rest, const dvec3& direction) {
    Expansion<3> e[3], f[3];
    for (int k = 0; k < 3; ++k) {
      e[k] = difference(v[1][k], v[0][k]);
      f[k] = difference(v[2][k], v[0][k]);
    }
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      const Expansion<24> n = cross<24>(e[l], f[m], e[m], f[l]);
      add_product(volume, n, difference(v[0][k], origin[k], rest[k]), 1);
      facing.add_product(n, direction[k]);
    }
  }
};

// The same two in doubles, and the sizes of the terms that they are sums of. a: from the line's origin to the
// first corner; a_size: the sizes of what a is a difference of.
struct RoundedQuotient {
  double volume, facing, volume_size = 0, facing_size = 0;

  RoundedQuotient(const ExactLine::Corners& v, const dvec3& a, const dvec3& a_size, const dvec3& direction) {
    const dvec3 e = v[1] - v[0], f = v[2] - v[0];
    const dvec3 n = glm::cross(e, f);
    volume = glm::dot(n, a), facing = glm::dot(n, direction);
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      const double part = std::abs(e[l] * f[m]) + std::abs(e[m] * f[l]);
      volume_size += part * a_size[k];
      facing_size += part * std::abs(direction[k]);
    }
  }
};

// The same number in as few doubles as there can be: each is below the last place of the next.
template <int kOther>
Expansion<48> compressed(const Expansion<kOther>& from) {
  std::array<double, kOther + 1> above;
  int n = 0;
  double sum = 0;
  for (const double* part = from.end(); part != from.begin();) {
    const double low = *--part, next = sum + low, rest = low - (next - sum);
    if (rest != 0) above[static_cast<std::size_t>(n++)] = next;
    sum = rest != 0 ? rest : next;
  }
  Expansion<48> few;
  few.add(sum);
  while (n > 0) few.add(above[static_cast<std::size_t>(--n)]);
  return few;
}

template <int kCapacity>
double rounded(const Expansion<kCapacity>& parts) {
  double sum = 0;
  for (const double part : parts) sum += part;
  return sum;
}

// The high part is the nearest double, but for 2^-50 of its last place.
Pair quotient(const Expansion<48>& a, const Expansion<48>& b) {
  const double divisor = rounded(b), about = rounded(a) / divisor;
  Expansion<144> left;
  for (const double part : a) left.add(part);
  left.add_product(b, -about);
  return exact_sum(about, rounded(left) / divisor);
}

}  // namespace

// Of a corner: x and y in the sheared plane times the direction's z, z along it, and what x and y are sums
// of.
struct ExactLine::Place {
  const dvec3* corner;
  double x, y, x_size, y_size;
};

ExactLine::ExactLine(const dvec3& origin, const dvec3& direction, const dvec3& rest)
    : origin_(without_tiny(origin, 0x1p-140)),
      direction_(without_tiny(direction, 0x1p-200)),
      rest_(without_tiny(rest, 0x1p-140)),
      kz_(0) {
  for (int k = 1; k < 3; ++k)
    if (std::abs(direction_[k]) >= std::abs(direction_[kz_])) kz_ = k;
  kx_ = (kz_ + 1) % 3;
  ky_ = (kz_ + 2) % 3;
}

// (Where the rest is of the size of a difference, the difference was not rounded.)
ExactLine::Place ExactLine::place_of(const dvec3& corner) const {
  const double z = corner[kz_] - origin_[kz_] - rest_[kz_], dz = direction_[kz_];
  const double x = (corner[kx_] - origin_[kx_] - rest_[kx_]) * dz, shift_x = z * direction_[kx_];
  const double y = (corner[ky_] - origin_[ky_] - rest_[ky_]) * dz, shift_y = z * direction_[ky_];
  return {&corner, x - shift_x, y - shift_y, std::abs(x) + std::abs(shift_x),
          std::abs(y) + std::abs(shift_y)};
}

// Of the edge from P to Q, from which side the moved point sees it: the sign of Qx*Py - Qy*Px, and where that
// is 0 of Qy - Py, and then of Px - Qx.
int ExactLine::side_of(const Place& p, const Place& q) const {
  const double side = q.x * p.y - q.y * p.x, size = q.x_size * p.y_size + q.y_size * p.x_size;
  return std::abs(side) > kSure * size ? sign_of(side) : exact_side_of(*p.corner, *q.corner);
}

int ExactLine::exact_side_of(const dvec3& p, const dvec3& q) const {
  const auto sheared = [&](const dvec3& corner, int k) {
    Expansion<12> place;
    place.add_product(difference(corner[k], origin_[k], rest_[k]), direction_[kz_]);
    place.add_product(difference(corner[kz_], origin_[kz_], rest_[kz_]), -direction_[k]);
    return place;
  };
  const Expansion<12> px = sheared(p, kx_), py = sheared(p, ky_), qx = sheared(q, kx_), qy = sheared(q, ky_);
  if (const int side = cross<576>(qx, py, qy, px).sign(); side != 0) return side;
  const auto less = [](const Expansion<12>& a, const Expansion<12>& b) {
    Expansion<24> sum;
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
  const dvec3 a = v[0] - origin_;
  const auto [volume, facing, volume_size, facing_size] = RoundedQuotient(v, a, glm::abs(a), direction_);
  if (std::abs(volume) > kSure * volume_size && std::abs(facing) > kSure * facing_size)
    return volume / facing;
  const int sign = ExactQuotient(v, origin_, rest_, direction_).volume.sign() * facing_sign;
  if (sign == 0) return 0;
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (const dvec3& corner : v) {
    const double t = (corner[kz_] - origin_[kz_]) / direction_[kz_];
    lo = std::min(lo, t), hi = std::max(hi, t);
  }
  const double t = facing == 0 ? 0.5 * (lo + hi) : std::clamp(volume / facing, lo, hi);
  constexpr double kLeast = std::numeric_limits<double>::min();
  return sign > 0 ? std::max(t, kLeast) : std::min(t, -kLeast);
}

ExactLine::Bounds ExactLine::around(double t) {
  const double off = 0x1p-50 * std::abs(t);
  return {t - off, t + off};
}

ExactLine::Bounds ExactLine::bounds_of_t(const Corners& v) const {
  const auto [volume, facing, volume_size, facing_size] =
      RoundedQuotient(v, v[0] - origin_ - rest_, glm::abs(v[0]) + glm::abs(origin_), direction_);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (!(std::abs(facing) > 4 * kSure * facing_size)) return {-kInfinity, kInfinity};
  const double t = volume / facing;
  const double off = 2 * kSure * (volume_size + std::abs(t) * facing_size) / std::abs(facing);
  return {t - off, t + off};
}

int ExactLine::side_of(const Place& a, const Place& b, const Place& c) const {
  const int side = side_of(a, b);
  return side == 0 || side != side_of(b, c) || side != side_of(c, a) ? 0 : side;
}

std::optional<ExactLine::Crossing> ExactLine::crossing(const Corners& v) const {
  const Place a = place_of(v[0]), b = place_of(v[1]), c = place_of(v[2]);
  const int side = side_of(a, b, c);
  if (side == 0) return std::nullopt;
  const auto weight = [](const Place& p, const Place& q) { return std::abs(q.x * p.y - q.y * p.x); };
  const double wa = weight(b, c), wb = weight(c, a), wc = weight(a, b), all = wa + wb + wc;
  const int facing_sign = direction_[kz_] > 0 ? -side : side;
  return Crossing{distance_to(v, facing_sign), all > 0 ? wb / all : 1.0 / 3, all > 0 ? wc / all : 1.0 / 3};
}

bool ExactLine::crosses(const Corners& v) const {
  return side_of(place_of(v[0]), place_of(v[1]), place_of(v[2])) != 0;
}

// A triangle that the line crosses isn't seen edge-on, so that what is divided by is not 0.
Pair ExactLine::t_in_pair(const Corners& v) const {
  const ExactQuotient t(v, origin_, rest_, direction_);
  return quotient(compressed(t.volume), compressed(t.facing));
}

int ExactLine::compare_t(const Corners& v, const Corners& w) const {
  const ExactQuotient one(v, origin_, rest_, direction_), other(w, origin_, rest_, direction_);
  const Expansion<48> volume = compressed(one.volume), facing = compressed(one.facing);
  const Expansion<48> other_volume = compressed(other.volume), other_facing = compressed(other.facing);
  Expansion<9216> difference_of_products;
  add_product(difference_of_products, volume, other_facing, 1);
  add_product(difference_of_products, other_volume, facing, -1);
  return difference_of_products.sign() * facing.sign() * other_facing.sign();
}

}  // namespace kdray::query
