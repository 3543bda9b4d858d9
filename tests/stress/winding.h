// What    The winding number of a closed mesh about a point, exactly: the oracle of inside().
// Shape   A half-line along +x from the point meets triangles, each of which counts 1 or -1 by the side that
//         it is met from. Whether it is met, and ahead, are signs of determinants of the doubles as they are:
//         by double arithmetic where its error can't change the sign, else by GMP's rationals. Where the line
//         goes through a corner or an edge the point is taken to lie at (y + e, z + e^2), with e smaller than
//         anything else, so that it goes through none. A grid across x keeps the triangles that a point asks
//         few. The number is odd exactly where an odd number of triangles is met, so it says whether the
//         point is inside of an odd number of surfaces also where a mesh has no consistent orientation.
// Source  Error bounds of the determinants: Shewchuk, "Adaptive precision floating-point arithmetic and fast
//         robust geometric predicates", 1997.
#pragma once

#include <vector>

#include "stress/placed.h"

namespace kdray::stress {

class Winding {
 public:
  explicit Winding(const ClosedShape& shape);

  // On the surface it may be the number of either side.
  int about(const dvec3& point) const;

 private:
  struct Cell {
    int i, j;
  };
  Cell cell_of(double y, double z) const;

  const ClosedShape* shape_;
  int side_;  // the grid has as many cells along y as along z
  std::vector<std::vector<std::uint32_t>> cells_;
};

// The same by solid angles, in double: for points that are not near the surface. Of every triangle.
double winding_by_angles(const ClosedShape& shape, const dvec3& point);

}  // namespace kdray::stress
