// What    Lines' ways through the wide tree of a scene of doubles, in floats: which triangles they may cross.
// Shape   Eight boxes of a node, or the triangles of a block, at a time, in the CPU's widest vectors
//         (Highway). Each triangle that is passed by is one that no half-line of doubles which these floats
//         are of crosses between `begin` and `end`; the rest is the decider's. Some lines are in flight at
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

class TriangleDecider {
 public:
  // How far the line of this number goes on; what is below its `begin` ends it.
  virtual float decide(std::size_t line, std::uint32_t triangle) = 0;

 protected:
  ~TriangleDecider() = default;
};

// Also fetches the doubles of triangles that are to be decided about.
void walk_triangles(const flatten::WideForm& wide, const scene::DoubleTriangles& doubles,
                    std::span<const LineInFloats> lines, TriangleDecider& decider);

}  // namespace kdray::query
