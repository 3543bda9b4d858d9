// What    Rays of doubles against the primitives of a scene of floats, in double on the host: for those that
//         begin so near to a surface that the kernels' floats can't tell on which side of it they are.
// Shape   Everything in the scene's own space. A line crosses triangles by exact signs (exact_triangle.h),
//         shapes as primitives/shape_tools.h says; of an instance in its mesh's space, to which the line is
//         moved once for all of its primitives.
// Why     A crossing is decided in floats wherever its ray begins farther from every surface than is_near()
//         allows: 32u of the ray's reach are more than the 20u that docs/design/queries.md asks for, and
//         2^-12 more than the way between a place of doubles and the floats that it is rounded to.
// Cost    A walk through the wide tree in plain C++: some ten times what a kernel takes.
// Threads As many calls at once as there are threads.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/prepare/prepared.h"
#include "engine/query/exact_triangle.h"
#include "scene/primitives/shape_tools.h"

namespace kdray::query {

struct ExactHit {
  double t;
  double u, v;             // of a scene of floats rounded to floats
  std::uint32_t ref;       // tree.layout.h
  std::uint32_t instance;  // by index, or kNoInstance
};

class ExactScene {
 public:
  explicit ExactScene(const prepare::Prepared& scene);

  // What is nearer than that to a surface floats may see on its other side: see above.
  static constexpr double kNear = 0x1p-6 + 0x1p-12;

  // Whether a surface lies so near that floats can't tell which side of it the place is on. It depends on the
  // primitives alone, not on the tree. The place lies within the scene's bounds.
  bool is_near(const dvec3& place) const;

  // All that the line crosses at t >= 0, sorted, in place of what `hits` held; beyond `most` some may be left
  // out. The direction's largest component is from 2^-8 to 2^8.
  void cross(const dvec3& origin, const dvec3& direction, double most, std::vector<ExactHit>& hits) const;
  // By t, then instance (what is in none first), then the primitive's number.
  void sort(std::vector<ExactHit>& hits) const;

  // t, in double, of a hit that floats have found at about `t`; `t` itself where the line misses the
  // primitive, or runs along it.
  double distance(const dvec3& origin, const dvec3& direction, std::uint32_t ref, std::uint32_t instance,
                  double t) const;

 private:
  struct Walk;
  bool is_near(std::uint32_t node, const dvec3& place, double margin, double within) const;
  bool is_near_instance(const layout::Instance& instance, const dvec3& place) const;
  void cross(std::uint32_t node, const Walk& walk) const;
  double distance_in_mesh(const primitives::Line& line, std::uint32_t ref, double t) const;

  const prepare::Prepared* scene_;
  double margin_;  // by which boxes are widened for rays
};

}  // namespace kdray::query
