#include "scene/transform.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <stdexcept>
#include <utility>

namespace kdray::scene {

namespace {

dvec3 transform_point(const dmat4& m, const dvec3& p) {
  return dvec3(m * glm::dvec4(p, 1));
}

// The factor by which a similarity (rotation, mirror, uniform scale) enlarges; throws for any other matrix.
double similarity_factor(const dmat3& m) {
  const double factor = glm::length(m[0]);
  const dmat3 square = glm::transpose(m) * m;
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      worst = std::max(worst, std::abs(square[i][j] - (i == j ? factor * factor : 0)));
    }
  }
  if (!(worst <= 1e-9 * factor * factor)) {
    throw std::domain_error("spheres and cones can be moved, turned and scaled alike along all axes only");
  }
  return factor;
}

}  // namespace

void apply_transform(const dmat4& m, Scene& scene) {
  const dmat3 linear(m);
  for (dvec3& p : scene.vertices) p = transform_point(m, p);
  if (!scene.normals.empty()) {
    const dmat3 of_normals = glm::transpose(glm::inverse(linear));
    for (vec3& n : scene.normals) n = vec3(glm::normalize(of_normals * dvec3(n)));
  }
  if (glm::determinant(linear) < 0) {
    for (Triangle& t : scene.triangles) {
      std::swap(t.vertex[1], t.vertex[2]);
      std::swap(t.normal[1], t.normal[2]);
    }
  }
  if (scene.spheres.empty() && scene.cones.empty()) return;
  const double factor = similarity_factor(linear);
  for (Sphere& s : scene.spheres) {
    s.center = transform_point(m, s.center);
    s.radius *= factor;
  }
  for (Cone& c : scene.cones) {
    c.base = transform_point(m, c.base);
    c.apex = transform_point(m, c.apex);
    c.base_radius *= factor;
    c.apex_radius *= factor;
  }
}

dmat4 translation(const dvec3& by) {
  return glm::translate(dmat4(1), by);
}
dmat4 scaling(const dvec3& by) {
  return glm::scale(dmat4(1), by);
}
dmat4 rotation(const dvec3& unit_axis, double radians) {
  return glm::rotate(dmat4(1), radians, unit_axis);
}

}  // namespace kdray::scene
