// What    What the files of the kinds share: names of fields, placements, boxes, lines and where they cross a
//         shape, and how vectors go into the kernels' structs.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>

#include "base/box.h"
#include "base/local_space.h"
#include "base/pair.h"
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

// Returns a unit vector at right angles to an axis of length 1: any, or in the direction of `way`, where that
// has one.
dvec3 any_across(const dvec3& axis);
dvec3 unit_across(const dvec3& axis, const dvec3& way);

// Returns how far a disc of radius 1 across an axis reaches along x, y and z: sqrt(1 - w_i^2) for the unit
// axis w. Written as sqrt((w_j^2 + w_k^2) / w^2), which has no cancellation when the axis is nearly parallel
// to i.
dvec3 disc_reach(const dvec3& axis);

// ---- Rays and shapes in double, about the scene's centre, on the primitives as rays see them: where a line
// crosses a shape, for queries in double; and what is certain of it with the error known, for `kdray verify`.
// Crossings are off by some 2^-50 of the lengths in play, and whether there are two of them or none where the
// line all but touches the shape is decided by as much. Of a sphere or a torus the number of them ahead of
// the origin is odd where that is inside.
// A scene of doubles has its shapes as the file or the caller has them, but in its own space, with directions
// of about unit length. Their crossings are found in pairs of doubles, with the same formulas: what is
// decided is off by some 2^-96 of the shape's size (of a cone that is flat, by as much more as it is wider
// than high), and t is the nearest double, nearly always. What touches a torus is decided as above; its t is
// made better by a step of Newton's.

// Exactly origin + rest + t*direction. Crossings of a scene of doubles with t below `first` or above `last`
// may be left out.
struct Line {
  dvec3 origin, direction, rest{0};
  double first = -std::numeric_limits<double>::infinity(), last = -first;
};

// A vector of doubles or of pairs.
template <class Real>
using Vec = glm::vec<3, Real>;
template <class Real>
Real dot(const Vec<Real>& a, const Vec<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
Real length(const Vec<Real>& v) {
  using std::sqrt;
  return sqrt(dot(v, v));
}

// Along a line a solid's surface is where a*t^2 + 2*b*t + c = 0; inside it is negative. A cone's is that of
// the whole double cone.
struct Quadratic {
  double a, b, c;
};

// Where a line crosses a shape: t in ascending order, and u as hits have it.
struct Crossings {
  struct At {
    double t, u, rest = 0;  // t + rest: of a scene of doubles
  };
  std::array<At, 4> at{};
  std::size_t n = 0;

  void add(double t, double u = 0) { at[n++] = {t, u}; }
  void add(const Pair& t, const Pair& u = 0.0) { at[n++] = {t.high, double(u), t.low}; }
  const At* begin() const { return at.data(); }
  const At* end() const { return at.data() + n; }
};

// A line about a place, from where it comes about nearest to that; t there is `ahead` less. Off by 2^-100 of
// the way from there.
class LineNear {
 public:
  LineNear(const dvec3& place, const Line& line);

  const Vec<Pair>& from() const { return from_; }
  const Vec<Pair>& direction() const { return direction_; }
  Pair line_t(const Pair& t) const { return t + ahead_; }

  // Whether it passes by, for certain, all that lies within `reach` of the place, which may be rounded; or
  // does so where its crossings count.
  bool misses(double reach) const;
  // The same of what lies within `reach` of an axis through the place.
  bool misses(const dvec3& axis, double reach) const;

 private:
  const Line& line_;
  Vec<Pair> from_, direction_;
  Pair ahead_;
  double slack_;  // more than the place may be rounded by
};

// What of a shape lies nearest to a point.
struct NearestOn {
  double distance;
  dvec3 point;
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
