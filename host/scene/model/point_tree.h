// What    Points of the plane that come and go as obstacles, and the question whether one of them lies in a
//         triangle: a kd-tree over all points, made once, whose nodes count the obstacles below them.
// Shape   The points lie in one array, ordered so that each range [first, last) of the tree has its median,
//         along the longer side of its box, in the middle. Nodes are numbered as in a heap.
// Why     A polygon of n corners asks n times. Looking at all obstacles between two x, as a sorted list must,
//         takes n^2 steps for long ears: hours for a million corners.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "scene/model/predicates.h"

namespace kdray::scene {

class PointTree {
 public:
  explicit PointTree(const std::vector<dvec2>& points);

  void set(std::uint32_t point, bool is_obstacle);

  // Returns whether `blocks(point)` is true of an obstacle in the box; it is called for few others.
  // `passes_by(lo, hi)` may say of a box that it holds none.
  template <class Blocks, class PassesBy>
  bool any_within(const dvec2& lo, const dvec2& hi, const Blocks& blocks, const PassesBy& passes_by) const {
    return !order_.empty() && any_below(1, 0, order_.size(), lo, hi, blocks, passes_by);
  }

 private:
  struct Node {
    dvec2 lo, hi;
    std::uint32_t obstacles = 0;
  };
  static constexpr std::size_t kLeaf = 8;

  static bool holds(const dvec2& lo, const dvec2& hi, const dvec2& p) {
    return p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y;
  }

  void build(std::size_t node, std::size_t first, std::size_t last);

  template <class Blocks, class PassesBy>
  bool any_below(std::size_t node, std::size_t first, std::size_t last, const dvec2& lo, const dvec2& hi,
                 const Blocks& blocks, const PassesBy& passes_by) const {
    const Node& n = nodes_[node];
    if (n.obstacles == 0 || n.lo.x > hi.x || n.hi.x < lo.x || n.lo.y > hi.y || n.hi.y < lo.y) return false;
    if (last - first <= kLeaf) {
      for (std::size_t i = first; i < last; ++i)
        if (is_obstacle_[order_[i]] && holds(lo, hi, points_[order_[i]]) && blocks(order_[i])) return true;
      return false;
    }
    if (passes_by(n.lo, n.hi)) return false;
    const std::size_t middle = first + (last - first) / 2;
    return any_below(2 * node, first, middle, lo, hi, blocks, passes_by) ||
           any_below(2 * node + 1, middle, last, lo, hi, blocks, passes_by);
  }

  const std::vector<dvec2>& points_;
  std::vector<std::uint32_t> order_;
  std::vector<std::size_t> leaf_of_;  // of each point
  std::vector<bool> is_obstacle_;
  std::vector<Node> nodes_;
};

inline PointTree::PointTree(const std::vector<dvec2>& points)
    : points_(points), order_(points.size()), leaf_of_(points.size()), is_obstacle_(points.size(), false) {
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.resize(4 * std::bit_ceil(points.size() / kLeaf + 1));
  build(1, 0, order_.size());
}

inline void PointTree::build(std::size_t node, std::size_t first, std::size_t last) {
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

inline void PointTree::set(std::uint32_t point, bool is_obstacle) {
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
