// What    Families of rays that begin and end outside of a closed mesh, so that they cross it an even number
//         of times: at random, through vertices and points of edges, along the axes and the diagonals of
//         grids, in planes of faces.
// Shape   In double, in the world; one of four begins up to a million sizes away. Where a family aims at a
//         place along an axis or a diagonal, the ray goes through that place's own coordinates and not
//         through others that are rounded from them.
#pragma once

#include <array>
#include <string>

#include "stress/placed.h"
#include "stress/random.h"

namespace kdray::stress {

struct Line {
  dvec3 origin, direction;
};

struct LineFamily {
  const char* name;
  Line (*make)(const ClosedShape&, Random&);
};
extern const std::array<LineFamily, 7> kLineFamilies;

// A corner; and a point of an edge, halfway where rounding leaves that exact more often than not.
dvec3 some_corner(const ClosedShape& shape, Random& random);
dvec3 some_edge_point(const ClosedShape& shape, Random& random);

std::string in_words(const Line& line);

}  // namespace kdray::stress
