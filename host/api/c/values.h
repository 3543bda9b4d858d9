// What    Colours, vectors and cameras of kdray.h as C++'s.
#pragma once

#include <array>

#include "api/c/boundary.h"

namespace kdray::capi {

inline Color color(const float (&c)[3]) {
  return {c[0], c[1], c[2]};
}

inline Vec3 vector(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}
// The same, or what three zeros stand for.
inline Vec3 vector_or(const double (&v)[3], const Vec3& none) {
  return vector(v) == Vec3{0, 0, 0} ? none : vector(v);
}

Camera camera_of(const kdray_camera* given);

}  // namespace kdray::capi
