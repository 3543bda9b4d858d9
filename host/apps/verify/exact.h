// What    What is certain: what one primitive does to one ray, in double and with the error known (triangles'
//         part is here, the shapes' in scene/primitives/<kind>.h); and whether a point is inside a watertight
//         component, by the number of its faces that the ray from the point along +x crosses (odd: inside).
// Shape   Everything about the scene's centre, on the primitives as rays see them. A point is `unsure` where
//         it is nearer to the component than `clearance`, or where the ray meets an edge: never a guess.
// Errors  None: the crossings are decided in the plane across x by exact predicates, before or behind the
//         point by a sign whose error is bounded (and unsure within that bound).
// Source  Shewchuk 1997 for the predicates (scene/model/predicates.h) and the error bound of the determinant.
#pragma once

#include <optional>

#include "apps/verify/edges.h"
#include "apps/verify/mesh.h"
#include "kdray/kdray.h"
#include "scene/model/geometry.h"
#include "scene/primitives/shapes.h"

namespace kdray::verify {

using primitives::Line;
inline Line line_of(const Ray& ray) {
  return {{ray.origin[0], ray.origin[1], ray.origin[2]},
          {ray.direction[0], ray.direction[1], ray.direction[2]}};
}

// Returns t where the line surely meets the triangle: where it passes the outline on the inner side, by more
// than `margin`, a length.
std::optional<double> sure_hit(const Line& line, const dvec3& a, const dvec3& b, const dvec3& c,
                               double margin);

// Returns +1 or -1 where the plane of the triangle surely lies before or behind the line's origin; 0: the
// origin may lie in it.
int side_of_plane(const Line& line, const dvec3& a, const dvec3& b, const dvec3& c);

enum class Side { inside, outside, unsure };

class Insides {
 public:
  Insides(const Mesh& mesh, const Boxes& boxes, const Topology& topology)
      : mesh_(mesh), boxes_(boxes), topology_(topology) {}

  Side side_of(const dvec3& point, std::uint32_t component, double clearance) const;

 private:
  bool near(const dvec3& point, std::uint32_t component, double clearance) const;

  const Mesh& mesh_;
  const Boxes& boxes_;
  const Topology& topology_;
};

}  // namespace kdray::verify
