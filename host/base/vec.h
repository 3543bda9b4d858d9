// What    The vector types of the host: GLM's, under kdray's names. Positions in files are double, positions
//         on the device are float about the scene's centre (see scene/model/geometry.h).
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace kdray {

using vec2 = glm::vec2;
using vec3 = glm::vec3;
using dvec3 = glm::dvec3;
using dmat3 = glm::dmat3;
using dmat4 = glm::dmat4;

inline bool is_finite(const dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace kdray
