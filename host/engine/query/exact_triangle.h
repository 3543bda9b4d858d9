// What    Whether a line through a point of doubles crosses a triangle of floats, and where: by the half-open
//         rule (kernels/intersect/crossing.clh), with exact signs.
// Shape   Corners are looked at in the plane that is sheared along the line, about the line: a corner's place
//         there depends on the line and the corner alone, and is never rounded. So the rule's proof holds for
//         the mesh as it is: every line crosses a closed mesh an even number of times. On which side of the
//         origin a crossing lies is the sign of a volume, of the same exactness.
// Errors  None in what is decided. t, u and v are off by some 2^-50 of their terms; the sign of t is right.
//         Coordinates of the origin below 2^-140 and of the direction below 2^-200 count as 0: so no product
//         underflows.
// Source  Shewchuk 1997 (scene/predicates.h). Nearly all signs are sure in doubles already.
#pragma once

#include <optional>

#include "base/vec.h"

namespace kdray::query {

class ExactLine {
 public:
  // The direction's largest component is from 2^-8 to 2^8.
  ExactLine(const dvec3& origin, const dvec3& direction);

  const dvec3& origin() const { return origin_; }
  const dvec3& direction() const { return direction_; }

  struct Crossing {
    double t, u, v;
  };
  using Corners = float[3][3];
  std::optional<Crossing> crossing(const Corners& corners) const;

 private:
  struct Place;
  Place place_of(const float (&corner)[3]) const;
  int side_of(const Place& p, const Place& q) const;
  int exact_side_of(const float (&p)[3], const float (&q)[3]) const;
  double distance_to(const Corners& corners, int facing_sign) const;

  dvec3 origin_, direction_;
  int kx_, ky_, kz_;  // z is the direction's largest component
};

}  // namespace kdray::query
