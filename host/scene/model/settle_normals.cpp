#include "scene/model/settle_normals.h"

#include <algorithm>
#include <cmath>

#include "scene/model/first_fault.h"

namespace kdray::scene {

namespace {

constexpr bool is_zero(const vec3& v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

bool uses_zero(const Scene& scene, const Triangle& t) {
  return std::ranges::any_of(t.normal, [&](std::uint32_t n) { return is_zero(scene.normals[n]); });
}

std::size_t flatten(Scene& scene) {
  std::size_t n_flat = 0;
  for (Triangle& t : scene.triangles) {
    if (t.normal[0] == kNone || !uses_zero(scene, t)) continue;
    t.normal.fill(kNone);
    ++n_flat;
  }
  return n_flat;
}

}  // namespace

vec3 direction_of(const dvec3& v) {
  // The vector is scaled first, so that the squares of very short and very long ones don't vanish or
  // overflow.
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0)) return vec3(0);
  const dvec3 scaled = v / largest;
  if (!is_finite(scaled)) return vec3(0);
  return vec3(scaled / glm::length(scaled));
}

std::size_t settle_normals(Scene& scene, const std::string& file) {
  bool any_zero = false;
  for (vec3& n : scene.normals) {
    n = direction_of(dvec3(n));
    any_zero = any_zero || is_zero(n);
  }
  if (!any_zero) return 0;
  const std::size_t n_flat = flatten(scene);
  for (vec3& n : scene.normals) {
    if (is_zero(n)) n = vec3(0, 0, 1);
  }
  if (n_flat > 0) scene.warnings.push_back(flat_warning(file, n_flat));
  return n_flat;
}

void settle_vertices(Scene& scene, const std::function<std::string(std::size_t)>& place_of) {
  const auto good = [&](std::size_t i) { return is_finite(scene.vertices[i]); };
  const std::size_t first = first_fault(scene.vertices.size(), good);
  if (first == scene.vertices.size()) return;
  std::size_t n_triangles = 0, n_vertices = 0;
  for (Triangle& t : scene.triangles) {
    const auto bad = std::ranges::find_if(t.vertex, [&](std::uint32_t v) { return !good(v); });
    if (bad == t.vertex.end()) continue;
    t.vertex.fill(*bad);
    ++n_triangles;
  }
  for (dvec3& v : scene.vertices) {
    if (is_finite(v)) continue;
    v = dvec3(0);
    ++n_vertices;
  }
  scene.warnings.push_back(place_of(first) + ": " + std::to_string(n_vertices) +
                           " vertices are not finite (this is the first): the " +
                           std::to_string(n_triangles) + " triangles that use them are left out");
}

std::string flat_warning(const std::string& file, std::size_t n_flat) {
  return file + ": " + std::to_string(n_flat) +
         " triangles have a corner normal without a direction: they are shaded flat";
}

}  // namespace kdray::scene
