// What    The triangles of a scene as a mesh: corners at one place are one point, whatever the file says. And
//         a tree of boxes about them: what touches a box, which pairs touch each other. It is the plainest
//         kind, apart from kdray's kd-tree: what is checked must not be what checks it.
// Shape   Places are those that rays see (float, about the scene's centre), so that a seam that is closed
//         here is closed to every ray. Triangles keep Geometry's order: triangle i here is
//         Geometry::triangles[i]. Degenerate ones are not among them.
//         The tree is a perfect binary one over the triangles in the order of their middles: node j of level
//         l holds the triangles [n*j >> l, n*(j+1) >> l) of `order_`, and boxes_ has the levels one after the
//         other.
#pragma once

#include <tbb/parallel_invoke.h>

#include <array>
#include <cstdint>
#include <vector>

#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::verify {

using Corners = std::array<std::uint32_t, 3>;  // into Mesh::points

struct Mesh {
  std::vector<vec3> points;             // all different
  std::vector<Corners> triangles;       // corners
  std::vector<std::uint32_t> numbers;   // of each triangle, in file order over all kinds of primitives
  std::vector<std::uint8_t> zero_area;  // of each: 1 where it has no area (scene/model/zero_area.h)
  Box bounds;                           // of the points

  const vec3& corner(std::size_t triangle, std::size_t k) const { return points[triangles[triangle][k]]; }
  // Returns the normal of the front, where corners go counter-clockwise, twice the area long; 0 where there
  // is no area, whatever rounding says.
  dvec3 normal(std::size_t triangle) const;
  Box bounds_of(std::size_t triangle) const;
};

Mesh make_mesh(const scene::Scene& scene, const scene::Geometry& geometry);

class Boxes {
 public:
  explicit Boxes(const Mesh& mesh);

  // Calls visit(triangle) for each triangle whose box touches `box`; visit returns whether to go on.
  template <class Visit>
  void touching(const DBox& box, const Visit& visit) const {
    if (!order_.empty()) touching_below(0, 0, box, visit);
  }

  // Calls visit(i, j) once for each pair of triangles whose boxes touch, from several threads at a time.
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

  // Visits the pairs of one triangle below node a and one below node b of the same level; a == b: each pair
  // once.
  template <class Visit>
  void pairs(std::uint32_t level, std::uint64_t a, std::uint64_t b, const Visit& visit) const;

  std::uint32_t levels_ = 0;  // below the root
  std::vector<std::uint32_t> order_;
  std::vector<Box> own_;    // the triangles' boxes, in their order
  std::vector<Box> boxes_;  // the nodes'
};

template <class Visit>
void Boxes::touching_pairs(const Visit& visit) const {
  if (!order_.empty()) pairs(0, 0, 0, visit);
}

template <class Visit>
void Boxes::pairs(std::uint32_t level, std::uint64_t a, std::uint64_t b, const Visit& visit) const {
  if (a != b && !touch(box_of(level, a), box_of(level, b))) return;
  if (level == levels_) {
    for (std::size_t i = first_of(level, a); i < first_of(level, a + 1); ++i)
      for (std::size_t j = a == b ? i + 1 : first_of(level, b); j < first_of(level, b + 1); ++j)
        if (touch(own_[i], own_[j])) visit(order_[i], order_[j]);
    return;
  }
  const auto below = [&](std::uint64_t i, std::uint64_t j) { pairs(level + 1, 2 * a + i, 2 * b + j, visit); };
  constexpr std::uint32_t kParallelLevels = 8;
  if (a == b) {
    if (level < kParallelLevels) {
      tbb::parallel_invoke([&] { below(0, 0); }, [&] { below(1, 1); });
    } else {
      below(0, 0), below(1, 1);
    }
    below(0, 1);
  } else if (level < kParallelLevels) {
    tbb::parallel_invoke([&] { below(0, 0), below(0, 1); }, [&] { below(1, 0), below(1, 1); });
  } else {
    below(0, 0), below(0, 1), below(1, 0), below(1, 1);
  }
}

}  // namespace kdray::verify
