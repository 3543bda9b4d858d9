// What    Zero-area triangles: their three corners differ but lie on one line. They close a mesh where a
//         corner of one face lies on an edge of another: projected onto a ray the three corners are rounded
//         apart, and the gap that this leaves between the faces is the triangle (docs/design/numerics.md).
// Shape   Such a triangle has no plane, so it is shaded by the normals of its corners or, where the file has
//         none, by that of a neighbour: a triangle with area that shares two of its corners, the one at its
//         longest edge where there is one; else by what its neighbours without area are shaded by.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/memory.h"
#include "base/vec.h"
#include "layout/primitives.layout.h"

namespace kdray::scene {

// Returns whether a triangle of floats has exactly no area: its three projections all have none.
bool is_flat(const layout::Triangle& t);

// Returns whether a triangle of the file, of these edges, has an area that is more than the rounding of its
// decimals.
inline bool has_area(const dvec3& e, const dvec3& f) {
  return glm::length(glm::cross(e, f)) > 0x1p-40 * glm::length(e) * glm::length(f);
}

inline bool has_equal_corners(const layout::Triangle& t) {
  const auto equal = [&t](int i, int j) {
    return t.v[i][0] == t.v[j][0] && t.v[i][1] == t.v[j][1] && t.v[i][2] == t.v[j][2];
  };
  return equal(0, 1) || equal(1, 2) || equal(2, 0);
}

inline bool is_zero_area(const layout::Triangle& t) {
  return (t.normals & KDRAY_ZERO_AREA) != 0;
}

struct ZeroAreaTriangle {
  std::uint32_t triangle = 0;  // its place among the triangles
  vec3 normal{0};              // a neighbour's, of unit length; 0: it has none with area
};

// Returns the triangles that are marked as such, in the order of the triangles.
std::vector<ZeroAreaTriangle> find_zero_area(const Array<layout::Triangle>& triangles);

// Finds the same in steps, where the triangles are divided among processes: each has the sides of all
// zero-area triangles, and has its own triangles meet them.
class ZeroAreaSides {
 public:
  static constexpr std::uint32_t kNobody = 0xffffffffu;

  // `zero_area` has all zero-area triangles of the scene, in the order of its triangles.
  explicit ZeroAreaSides(std::span<const layout::Triangle> zero_area);
  ~ZeroAreaSides();
  ZeroAreaSides(const ZeroAreaSides&) = delete;
  ZeroAreaSides& operator=(const ZeroAreaSides&) = delete;

  // Meets a triangle, whose place among all is `place`; any thread may call it. A triangle without area meets
  // no side.
  void meet(const layout::Triangle& t, std::uint32_t place);

  // Returns for each side the least place of a triangle that shares it, or kNobody. The caller lowers it to
  // what other processes found.
  std::span<std::uint32_t> neighbours() { return neighbours_; }

  // Returns the normal of each zero-area triangle, when all have met. `normal_of(side)` is normal_of() the
  // side's neighbour, where it has one.
  std::vector<vec3> normals(const std::function<vec3(std::size_t side)>& normal_of) const;

  // Returns a normal of unit length, or 0 where the triangle has none.
  static vec3 normal_of(const layout::Triangle& t);

 private:
  struct Side;
  class Filter;
  struct ByEdge;

  std::size_t n_zero_area_;
  std::vector<Side> sides_;  // by edge
  std::vector<std::uint32_t> neighbours_;
  std::unique_ptr<Filter> filter_;
};

}  // namespace kdray::scene
