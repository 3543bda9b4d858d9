// What    The space that a scene is traced in: its own centre is the origin, and its largest coordinate is
//         from kLocalReach to twice that.
// Shape   local = (world - center) * scale. The scale is a power of two, so that multiplying by it rounds
//         nothing: a scene and the same scene 2^k times as large have the same local floats, and the same
//         picture.
// Why     Floats have 24 bits at any size, but the kernels multiply up to four lengths. With 2^10 these
//         products stay within float's range for lights as far off as 2^40 times the scene's size, and for
//         triangles as small as 2^-40 of it.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace kdray {

inline constexpr double kLocalReach = 0x1p10;

struct LocalSpace {
  dvec3 center{0};
  double scale = 1;

  dvec3 local(const dvec3& world) const { return (world - center) * scale; }
  dvec3 world(const dvec3& local) const { return local / scale + center; }
  double local_length(double world) const { return world * scale; }
  double world_length(double local) const { return local / scale; }
  bool operator==(const LocalSpace&) const = default;
};

inline double largest_component(const dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// Returns the power of two that takes `size` into [1, 2); 1 for a size of 0 or infinity. Its own inverse is a
// double too.
inline double scale_to_one(double size) {
  if (!(size > 0) || !std::isfinite(size)) return 1;
  return std::ldexp(1.0, std::clamp(-std::ilogb(size), -1022, 1022));
}

// Return a vector's length and its direction, where its components' squares may leave the range of double.
inline double safe_length(const dvec3& v) {
  const double scale = scale_to_one(largest_component(v));
  return glm::length(v * scale) / scale;
}
inline dvec3 safe_normalize(const dvec3& v) {
  return glm::normalize(v * scale_to_one(largest_component(v)));
}

}  // namespace kdray
