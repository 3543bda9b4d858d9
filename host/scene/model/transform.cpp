#include "scene/model/transform.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "scene/model/tangents.h"

namespace kdray::scene {

namespace {

dvec3 transform_point(const dmat4& m, const dvec3& p) {
  return dvec3(m * glm::dvec4(p, 1));
}

// The factor by which a similarity (rotation, mirror, uniform scale) enlarges; throws for any other matrix.
double similarity_factor(const dmat3& m, const std::string& what) {
  const double factor = glm::length(m[0]);
  const dmat3 square = glm::transpose(m) * m;
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      worst = std::max(worst, std::abs(square[i][j] - (i == j ? factor * factor : 0)));
    }
  }
  if (!(worst <= 1e-9 * factor * factor)) {
    throw std::domain_error(what + " can be moved, turned and scaled alike along all axes only");
  }
  return factor;
}

// What is in front stays there when all is mirrored: the second and third corners change places, with all
// that is at them.
void turn_round(Scene& scene) {
  for (Triangle& t : scene.triangles) {
    std::swap(t.vertex[1], t.vertex[2]);
    std::swap(t.normal[1], t.normal[2]);
  }
  for (layout::CornerColors& colors : scene.texturing.colors) std::swap(colors.c[1], colors.c[2]);
  for (auto* const set :
       {&scene.texturing.texcoords[0], &scene.texturing.texcoords[1], &scene.texturing.tangents})
    for (layout::TexCoords& at : *set) std::swap(at.uv[1], at.uv[2]);
}

}  // namespace

void apply_transform(const dmat4& m, Scene& scene) {
  const dmat3 linear(m);
  for (dvec3& p : scene.vertices) p = transform_point(m, p);
  if (!scene.normals.empty()) {
    const dmat3 of_normals = glm::transpose(glm::inverse(linear));
    for (vec3& n : scene.normals) n = vec3(glm::normalize(of_normals * dvec3(n)));
  }
  move_tangents(linear, scene.texturing.tangents);
  if (glm::determinant(linear) < 0) turn_round(scene);
  primitives::for_each_shape([&](auto kind) {
    auto& shapes = decltype(kind)::of(scene);
    if (shapes.empty()) return;
    const primitives::Similarity similarity{m, similarity_factor(linear, decltype(kind)::kNames)};
    for (auto& shape : shapes) transform(similarity, shape);
  });
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
