// What    Axis-aligned boxes: BasicBox over float or double vectors, and Bounds, whose axis is an index at
//         run time, for cells and for the parts of primitives in them; and rounding to float in a stated
//         direction, by which bounds computed in double become floats that still contain them.
// Shape   An empty box has lo = +inf, hi = -inf.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "base/vec.h"

namespace kdray {

template <class Vec>
struct BasicBox {
  using Scalar = typename Vec::value_type;
  Vec lo{std::numeric_limits<Scalar>::infinity()};
  Vec hi{-std::numeric_limits<Scalar>::infinity()};

  bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  Vec extent() const { return hi - lo; }
  Vec center() const { return lo + (hi - lo) * Scalar(0.5); }
  void grow(const Vec& p) { lo = glm::min(lo, p), hi = glm::max(hi, p); }
  void grow(const BasicBox& b) { lo = glm::min(lo, b.lo), hi = glm::max(hi, b.hi); }
  bool contains(const BasicBox& b) const {
    return b.empty() || (glm::all(glm::lessThanEqual(lo, b.lo)) && glm::all(glm::lessThanEqual(b.hi, hi)));
  }
  // Returns the surface area of the six faces; 0 for an empty box.
  Scalar area() const {
    if (empty()) return 0;
    const Vec e = extent();
    return 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
  }
};

template <class Vec>
BasicBox<Vec> intersection(const BasicBox<Vec>& a, const BasicBox<Vec>& b) {
  return {glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)};
}

using Box = BasicBox<vec3>;
using DBox = BasicBox<dvec3>;

struct Bounds {
  std::array<float, 3> lo, hi;

  // True when no point is in all three intervals; a flat box is not empty.
  bool empty() const { return !(lo[0] <= hi[0] && lo[1] <= hi[1] && lo[2] <= hi[2]); }
};

inline Bounds no_bounds() {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  return {{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};
}

inline Bounds intersection(const Bounds& a, const Bounds& b) {
  Bounds c;
  for (int k = 0; k < 3; ++k) {
    c.lo[k] = std::max(a.lo[k], b.lo[k]);
    c.hi[k] = std::min(a.hi[k], b.hi[k]);
  }
  return c;
}

inline Bounds hull(const Bounds& a, const Bounds& b) {
  Bounds c;
  for (int k = 0; k < 3; ++k) {
    c.lo[k] = std::min(a.lo[k], b.lo[k]);
    c.hi[k] = std::max(a.hi[k], b.hi[k]);
  }
  return c;
}

inline Bounds below(Bounds b, int axis, float position) {
  b.hi[axis] = std::min(b.hi[axis], position);
  return b;
}
inline Bounds above(Bounds b, int axis, float position) {
  b.lo[axis] = std::max(b.lo[axis], position);
  return b;
}

inline Bounds bounds_from(const Box& b) {
  return {{b.lo.x, b.lo.y, b.lo.z}, {b.hi.x, b.hi.y, b.hi.z}};
}
inline Box box_from(const Bounds& b) {
  return {{b.lo[0], b.lo[1], b.lo[2]}, {b.hi[0], b.hi[1], b.hi[2]}};
}

// Returns the next float towards -infinity; -infinity stays.
inline float next_below(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  if (x == 0) return -std::numeric_limits<float>::denorm_min();
  if (x == -std::numeric_limits<float>::infinity()) return x;
  return std::bit_cast<float>(x > 0 ? bits - 1 : bits + 1);
}

// Return the largest float <= x, the smallest float >= x.
inline float round_down(double x) {
  const auto f = static_cast<float>(x);
  return f > x ? next_below(f) : f;
}
inline float round_up(double x) {
  return -round_down(-x);
}

}  // namespace kdray
