// What    Whether a line through a point of doubles crosses a triangle of floats or of doubles, and where: by
//         the half-open rule (kernels/intersect/crossing.clh), with exact signs.
// Shape   Corners are looked at in the plane that is sheared along the line, about the line: a corner's place
//         there depends on the line and the corner alone, and is never rounded. So the rule's proof holds for
//         the mesh as it is: every line crosses a closed mesh an even number of times. On which side of the
//         origin a crossing lies is the sign of a volume, of the same exactness.
// Errors  None in what is decided. t, u and v are off by some 2^-50 of their terms; the sign of t is right.
//         Coordinates of the origin below 2^-140 and of the direction below 2^-200 count as 0: so no product
//         underflows. Of triangles of doubles, with coordinates of 2^-100 or more, t_of is right to the last
//         place, and which t is the lesser (compare_t) is exact.
// Source  Shewchuk 1997 (scene/model/predicates.h). Nearly all signs are sure in doubles already.
#pragma once

#include <array>
#include <optional>

#include "base/pair.h"
#include "base/vec.h"

namespace kdray::query {

class ExactLine {
 public:
  // The direction's largest component is from 2^-8 to 2^8. The line goes through origin + rest, where rest is
  // what rounding left of the origin.
  ExactLine(const dvec3& origin, const dvec3& direction, const dvec3& rest = dvec3(0));

  const dvec3& origin() const { return origin_; }
  const dvec3& direction() const { return direction_; }

  struct Crossing {
    double t, u, v;
  };
  using Corners = std::array<dvec3, 3>;
  std::optional<Crossing> crossing(const Corners& corners) const;

  bool crosses(const Corners& corners) const;
  // Of a triangle that it crosses: t, and what t_of tells, lie between these; infinite where that isn't
  // plain.
  struct Bounds {
    double least, most;
  };
  Bounds bounds_of_t(const Corners& corners) const;
  static Bounds around(double t);  // the exact t, of what t_of tells
  // Of a triangle that it crosses: t, slowly, and the sign of t less that of another such triangle. (Faster,
  // and weights: double_hits.h.)
  double t_of(const Corners& corners) const { return double(t_in_pair(corners)); }
  Pair t_in_pair(const Corners& corners) const;  // off by 2^-100 of itself
  int compare_t(const Corners& corners, const Corners& others) const;

 private:
  struct Place;
  Place place_of(const dvec3& corner) const;
  int side_of(const Place& p, const Place& q) const;
  int side_of(const Place& a, const Place& b, const Place& c) const;
  int exact_side_of(const dvec3& p, const dvec3& q) const;
  double distance_to(const Corners& corners, int facing_sign) const;

  dvec3 origin_, direction_, rest_;
  int kx_, ky_, kz_;  // z is the direction's largest component
};

}  // namespace kdray::query
