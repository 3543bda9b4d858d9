#include "scene/model/point_tree.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

namespace kdray::scene {

PointTree::PointTree(const std::vector<dvec2>& points)
    : points_(points), order_(points.size()), leaf_of_(points.size()), is_obstacle_(points.size(), false) {
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.resize(4 * std::bit_ceil(points.size() / kLeaf + 1));
  build(1, 0, order_.size());
}

void PointTree::build(std::size_t node, std::size_t first, std::size_t last) {
  Node& n = nodes_[node];
  n.lo = dvec2(std::numeric_limits<double>::infinity());
  n.hi = -n.lo;
  for (std::size_t i = first; i < last; ++i) {
    n.lo = glm::min(n.lo, points_[order_[i]]);
    n.hi = glm::max(n.hi, points_[order_[i]]);
  }
  if (last - first <= kLeaf) {
    for (std::size_t i = first; i < last; ++i) leaf_of_[order_[i]] = node;
    return;
  }
  const int axis = n.hi.x - n.lo.x > n.hi.y - n.lo.y ? 0 : 1;
  const std::size_t middle = first + (last - first) / 2;
  const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(last),
                   [&](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
  build(2 * node, first, middle);
  build(2 * node + 1, middle, last);
}

void PointTree::set(std::uint32_t point, bool is_obstacle) {
  if (is_obstacle_[point] == is_obstacle) return;
  is_obstacle_[point] = is_obstacle;
  for (std::size_t node = leaf_of_[point]; node > 0; node /= 2) {
    if (is_obstacle) {
      ++nodes_[node].obstacles;
    } else {
      --nodes_[node].obstacles;
    }
  }
}

}  // namespace kdray::scene
