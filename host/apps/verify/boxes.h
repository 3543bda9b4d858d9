// What    A tree of boxes about the triangles of a mesh: what touches a box, which pairs touch each other.
//         The plainest kind, apart from kdray's kd-tree: what is checked must not be what checks it.
// Shape   A perfect binary tree over the triangles in the order of their middles: node j of level l holds the
//         triangles [n*j >> l, n*(j+1) >> l) of `order_`, and boxes_ has the levels one after the other.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/verify/mesh.h"

namespace kdray::verify {

class Boxes {
 public:
  explicit Boxes(const Mesh& mesh);

  // Calls visit(triangle) for all whose box touches `box`; visit returns whether to go on.
  template <class Visit>
  void touching(const DBox& box, const Visit& visit) const {
    if (!order_.empty()) touching_below(0, 0, box, visit);
  }

  // Calls visit(i, j) once for all pairs of triangles whose boxes touch, in parallel where the levels are
  // split; `visit` must be safe to be called by several threads.
  template <class Visit>
  void touching_pairs(const Visit& visit) const;

  std::uint32_t levels() const { return levels_; }

 private:
  std::size_t first_of(std::uint32_t level, std::uint64_t j) const { return (order_.size() * j) >> level; }
  const Box& box_of(std::uint32_t level, std::uint64_t j) const {
    return boxes_[(std::size_t{1} << level) - 1 + j];
  }
  void sort_below(std::uint32_t level, std::uint64_t j, const std::vector<vec3>& middles);
  void bound_below(std::uint32_t level, std::uint64_t j, const Mesh& mesh);

  static bool touch(const Box& a, const DBox& b) {
    for (int k = 0; k < 3; ++k)
      if (a.lo[k] > b.hi[k] || a.hi[k] < b.lo[k]) return false;
    return true;
  }
  static bool touch(const Box& a, const Box& b) {
    return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y && a.lo.z <= b.hi.z &&
           b.lo.z <= a.hi.z;
  }

  template <class Visit>
  bool touching_below(std::uint32_t level, std::uint64_t j, const DBox& box, const Visit& visit) const {
    if (!touch(box_of(level, j), box)) return true;
    if (level < levels_)
      return touching_below(level + 1, 2 * j, box, visit) && touching_below(level + 1, 2 * j + 1, box, visit);
    for (std::size_t i = first_of(level, j); i < first_of(level, j + 1); ++i)
      if (touch(own_[i], box) && !visit(order_[i])) return false;
    return true;
  }

  // The pairs of one triangle below node a and one below node b of the same level; a == b: each pair once.
  template <class Visit>
  void pairs(std::uint32_t level, std::uint64_t a, std::uint64_t b, const Visit& visit) const;

  std::uint32_t levels_ = 0;  // below the root
  std::vector<std::uint32_t> order_;
  std::vector<Box> own_;    // the triangles' boxes, in their order
  std::vector<Box> boxes_;  // the nodes'
};

}  // namespace kdray::verify

#include "apps/verify/boxes-inl.h"
