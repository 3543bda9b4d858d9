// What    Right-handed rotations about an axis, as matrices for column vectors.
// Units   radians.
#pragma once

#include <cmath>

#include "base/vec.h"

namespace kdray::generate {

// `axis` has unit length.
inline dmat3 rotation(const dvec3& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto turned = [&](const dvec3& v) {
    return c * v + s * glm::cross(axis, v) + (1 - c) * glm::dot(axis, v) * axis;
  };
  return dmat3(turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1}));
}

inline dmat3 rotation_x(double angle) {
  return rotation({1, 0, 0}, angle);
}
inline dmat3 rotation_y(double angle) {
  return rotation({0, 1, 0}, angle);
}
inline dmat3 rotation_z(double angle) {
  return rotation({0, 0, 1}, angle);
}

}  // namespace kdray::generate
