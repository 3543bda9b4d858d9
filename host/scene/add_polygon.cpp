#include "scene/add_polygon.h"

#include <array>
#include <vector>

#include "scene/triangulate.h"

namespace kdray::scene {

namespace {

void add_triangle(Scene& scene, std::span<const std::uint32_t> corners,
                  std::span<const std::uint32_t> normals, const std::array<std::uint32_t, 3>& pick,
                  std::uint32_t material) {
  Triangle t{.vertex = {corners[pick[0]], corners[pick[1]], corners[pick[2]]}};
  if (!normals.empty()) t.normal = {normals[pick[0]], normals[pick[1]], normals[pick[2]]};
  t.material = material;
  t.number = static_cast<std::uint32_t>(scene.triangles.size());
  scene.triangles.push_back(t);
}

}  // namespace

std::string polygon_warning(std::size_t n_corners) {
  return "a polygon of " + std::to_string(n_corners) +
         " corners crosses itself too often to be cut up: part of it is a fan";
}

void add_polygon(Scene& scene, std::span<const std::uint32_t> corners, std::span<const std::uint32_t> normals,
                 std::uint32_t material) {
  if (corners.size() < 3) return;
  if (corners.size() == 3) return add_triangle(scene, corners, normals, {0, 1, 2}, material);
  std::vector<dvec3> points;
  points.reserve(corners.size());
  for (const std::uint32_t c : corners) points.push_back(scene.vertices[c]);
  bool finished = true;
  for (const auto& pick : triangulate(points, &finished))
    add_triangle(scene, corners, normals, pick, material);
  if (!finished) scene.warnings.push_back(polygon_warning(points.size()));
}

}  // namespace kdray::scene
