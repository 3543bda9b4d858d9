#include "engine/query/rule.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/vec.h"

namespace kdray::test {

namespace {

struct Shear {
  int kx, ky, kz;
  float sx, sy;
};

// The last of the largest components.
Shear shear_of(const Ray& ray) {
  const auto& d = ray.direction;
  int kz = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(d[k]) >= std::abs(d[kz])) kz = k;
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  return {kx, ky, kz, d[kx] / d[kz], d[ky] / d[kz]};
}

struct Corner {
  float x, y, z;
};

Corner corner_of(const Shear& s, const Ray& ray, const float (&v)[3]) {
  const float x = v[s.kx] - ray.origin[s.kx], y = v[s.ky] - ray.origin[s.ky], z = v[s.kz] - ray.origin[s.kz];
  return {std::fma(-s.sx, z, x), std::fma(-s.sy, z, y), z};
}

// The sign of Qx*Py - Qy*Px + e*(Qy - Py) + e^2*(Px - Qx).
int side_of(const Corner& p, const Corner& q) {
  const double one = double{q.x} * p.y, other = double{q.y} * p.x;
  if (one != other) return one > other ? 1 : -1;
  if (q.y != p.y) return q.y > p.y ? 1 : -1;
  return p.x == q.x ? 0 : (p.x > q.x ? 1 : -1);
}

double cross(const Corner& p, const Corner& q) {
  return double{q.x} * p.y - double{q.y} * p.x;
}

}  // namespace

std::vector<RuleHit> crossed_by_line(const Ray& ray, std::span<const layout::Triangle> triangles) {
  const Shear s = shear_of(ray);
  std::vector<RuleHit> hits;
  for (const layout::Triangle& t : triangles) {
    const Corner a = corner_of(s, ray, t.v[0]), b = corner_of(s, ray, t.v[1]), c = corner_of(s, ray, t.v[2]);
    const int side = side_of(b, c);
    if (side == 0 || side != side_of(c, a) || side != side_of(a, b)) continue;
    const double wa = cross(b, c), wb = cross(c, a), wc = cross(a, b), det = wa + wb + wc;
    const double most = std::max({std::abs(a.z), std::abs(b.z), std::abs(c.z)});
    const double z = det == 0 ? a.z : (wa * a.z + wb * b.z + wc * c.z) / det;
    const double speed = ray.direction[s.kz];
    hits.push_back({z / speed, 0x1p-20 * most / std::abs(speed), t.number});
  }
  std::sort(hits.begin(), hits.end(), [](const RuleHit& x, const RuleHit& y) { return x.t < y.t; });
  return hits;
}

}  // namespace kdray::test
