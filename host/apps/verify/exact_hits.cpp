#include "apps/verify/exact_hits.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kdray::verify {

std::optional<double> sure_hit(const Line& line, const dvec3& a, const dvec3& b, const dvec3& c,
                               double margin) {
  const dvec3 corner[3] = {a - line.origin, b - line.origin, c - line.origin};
  double weight[3], sum = 0;
  for (int k = 0; k < 3; ++k) {
    const dvec3 p = corner[(k + 1) % 3], q = corner[(k + 2) % 3];
    weight[k] = glm::dot(line.direction, glm::cross(p, q));
    // |weight| / |d x edge| is the distance of the two lines.
    if (!(std::abs(weight[k]) > margin * glm::length(glm::cross(line.direction, q - p)))) return {};
    if (weight[k] * weight[0] < 0) return {};
    sum += weight[k];
  }
  const dvec3 at = (weight[0] * corner[0] + weight[1] * corner[1] + weight[2] * corner[2]) / sum;
  return glm::dot(at, line.direction) / glm::dot(line.direction, line.direction);
}

int side_of_plane(const Line& line, const dvec3& a, const dvec3& b, const dvec3& c) {
  const dvec3 n = glm::cross(b - a, c - a), way = a - line.origin;
  const double away = glm::dot(n, way), along = glm::dot(n, line.direction);
  // The edges' and the products' roundings, as sums of absolute values.
  const dvec3 e = glm::abs(b - a), f = glm::abs(c - a);
  const dvec3 size(e.y * f.z + e.z * f.y, e.z * f.x + e.x * f.z, e.x * f.y + e.y * f.x);
  constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
  if (std::abs(away) <= kRounding * glm::dot(size, glm::abs(way))) return 0;
  if (std::abs(along) <= kRounding * glm::dot(size, glm::abs(line.direction))) return 0;
  return (away > 0) == (along > 0) ? 1 : -1;
}

}  // namespace kdray::verify
