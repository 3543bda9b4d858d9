// What    Lines' ways through the wide tree of a scene of doubles, in floats: which primitives they may
//         cross.
// Shape   Eight boxes of a node, or the triangles of a block, at a time, in the CPU's widest vectors
//         (Highway). Each triangle that is passed by is one that no half-line of doubles which these floats
//         are of crosses between `begin` and `end`; the rest is the decider's, as are the shapes of all
//         leaves that a line comes to. Some lines are in flight at
//         once, each a step at a time, so that what one needs next is fetched while the others take theirs.
// Why     Boxes: see double_scene.h. Triangles: a corner's place in the plane across the line, sheared, is
//         off by 16u of what the largest of its lengths can be: 2u for the rounding of vertex and origin,
//         each also by way of the shear, and 9u for that of the operations. Where it is off by no more than
//         e, and no corner's coordinate is above m, an edge function is off by 4*e*m + 2*e^2, and by 3u of
//         2*m^2 for its own rounding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "accel/flatten/wide.h"
#include "base/vec.h"
#include "scene/model/geometry.h"

namespace kdray::query {

struct LineInFloats {
  // `margin`: by which boxes are widened; `reach`: of the scene. Begin and end are to be filled in.
  LineInFloats(const dvec3& origin, const dvec3& direction, float margin, double reach);

  float begin, end;
  float origin[3], inverse[3];   // of the direction
  float first[3], last[3];       // what is taken from the bounds that come first and last
  std::uint32_t upper_first[3];  // 1: the upper bound comes first
  std::uint32_t octant;
  int axis[3];  // z is the direction's largest component
  float shear[2];
  float displaced;  // how far a corner may be off
};

class Decider {
 public:
  // How far the line of this number goes on, once it has come to a primitive (tree.layout.h); what is below
  // its `begin` ends it.
  virtual float decide(std::size_t line, std::uint32_t ref) = 0;

 protected:
  ~Decider() = default;
};

// Also fetches the doubles of triangles that are to be decided about.
void walk_primitives(const flatten::WideForm& wide, const scene::DoubleGeometry& doubles,
                     std::span<const LineInFloats> lines, Decider& decider);

}  // namespace kdray::query
