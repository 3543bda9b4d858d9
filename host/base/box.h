// What    Axis-aligned boxes over float or double; an empty box has lo = +inf, hi = -inf.
#pragma once

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
  // The surface area of the six faces; 0 for an empty box.
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

}  // namespace kdray
