// What    Whether a point is inside a watertight component, decided exactly: by the number of its faces that
//         the ray from the point along +x crosses (odd: inside).
// Shape   `unsure` where the point is nearer to the component than `clearance`, or the ray meets an edge:
//         never a guess.
// Errors  None: the crossings are decided in the plane across x by exact predicates, before or behind the
//         point by a sign whose error is bounded (and unsure within that bound).
// Source  Shewchuk 1997 for the predicates (scene/predicates.h) and the error bound of the determinant.
#pragma once

#include "apps/verify/boxes.h"
#include "apps/verify/edges.h"
#include "apps/verify/mesh.h"

namespace kdray::verify {

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
