// What    What the files of the kinds share: names of fields, placements, boxes, lines and where they cross a
//         shape, and how vectors go into the kernels' structs.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "base/box.h"
#include "base/local_space.h"
#include "base/vec.h"

namespace kdray::primitives {

// ---- The fields of a shape as kdray's JSON scenes name them, and arrays of them as a program does: the
// reader, the list of keys and Scene::add_shapes() follow from them.

enum class Meaning { point, direction, above_zero, at_least_zero, at_least_zero_or_left_out };

template <class Shape, class Value>
struct Field {
  std::string_view key, array;
  Value Shape::*member;
  Meaning meaning;
};
template <class Shape, class Value>
Field(std::string_view, std::string_view, Value Shape::*, Meaning) -> Field<Shape, Value>;

// ---- Placements in a file: the moves that keep a shape a shape of its kind.

// A rotation, mirror and uniform scale, then a move: what keeps a sphere a sphere.
struct Similarity {
  dmat4 matrix;
  double factor;  // by which it enlarges

  dvec3 point(const dvec3& p) const { return dvec3(matrix * glm::dvec4(p, 1)); }
  dvec3 direction(const dvec3& d) const { return dmat3(matrix) * d / factor; }
};

// ---- Boxes about a point, computed in double or float, that contain what they have to whatever the
// rounding.

// Returns the smallest box of floats that contains center -+ reach.
Box box_around(const vec3& center, const dvec3& reach);

// Returns the same box, wider than any rounding of a reach that was computed in float.
Box wide_box_around(const vec3& center, const vec3& reach);

// Returns how far a disc of radius 1 across an axis reaches along x, y and z: sqrt(1 - w_i^2) for the unit
// axis w. Written as sqrt((w_j^2 + w_k^2) / w^2), which has no cancellation when the axis is nearly parallel
// to i.
dvec3 disc_reach(const dvec3& axis);

// ---- Rays and shapes in double, about the scene's centre, on the primitives as rays see them: where a line
// crosses a shape, for queries in double; and what is certain of it with the error known, for `kdray verify`.
// Crossings are off by some 2^-50 of the lengths in play, and whether there are two of them or none where the
// line all but touches the shape is decided by as much. Of a sphere or a torus the number of them ahead of
// the origin is odd where that is inside.

struct Line {
  dvec3 origin, direction;
};

// Along a line a solid's surface is where a*t^2 + 2*b*t + c = 0; inside it is negative. A cone's is that of
// the whole double cone.
struct Quadratic {
  double a, b, c;
};

// Where a line crosses a shape: t in ascending order, and u as hits have it.
struct Crossings {
  struct At {
    double t, u;
  };
  std::array<At, 4> at{};
  std::size_t n = 0;

  void add(double t, double u = 0) { at[n++] = {t, u}; }
  const At* begin() const { return at.data(); }
  const At* end() const { return at.data() + n; }
};

// Returns whether a hit at t is surely none of a ray that has just left the surface, to the outside or to the
// inside: it began on the other side, or goes away from the solid, or is still on its way through the inside.
// (Where a <= 0, along a cone, nothing is sure.)
bool hits_again(const Quadratic& q, double t, bool outside);

// ---- For the kernels' structs

inline void set(float (&out)[3], const vec3& v) {
  for (int k = 0; k < 3; ++k) out[k] = v[k];
}

}  // namespace kdray::primitives
