#include "scene/model/add_polygon.h"

#include <array>
#include <vector>

#include "scene/model/triangulate.h"

namespace kdray::scene {

namespace {

void add_texcoords(Scene& scene, std::span<const std::array<float, 2>> texcoords,
                   const std::array<std::uint32_t, 3>& pick) {
  layout::TexCoords at{};
  for (std::size_t i = 0; i < 3; ++i)
    at.uv[i][0] = texcoords[pick[i]][0], at.uv[i][1] = texcoords[pick[i]][1];
  auto& all = scene.texturing.texcoords[0];
  all.resize(scene.triangles.size() - 1);  // those of earlier triangles that had none
  all.push_back(at);
}

void add_triangle(Scene& scene, std::span<const std::uint32_t> corners,
                  std::span<const std::uint32_t> normals, const std::array<std::uint32_t, 3>& pick,
                  std::uint32_t material, std::span<const std::array<float, 2>> texcoords) {
  Triangle t{.vertex = {corners[pick[0]], corners[pick[1]], corners[pick[2]]}};
  if (!normals.empty()) t.normal = {normals[pick[0]], normals[pick[1]], normals[pick[2]]};
  t.material = material;
  t.number = static_cast<std::uint32_t>(scene.triangles.size());
  scene.triangles.push_back(t);
  if (!texcoords.empty()) add_texcoords(scene, texcoords, pick);
}

}  // namespace

std::string polygon_warning(std::size_t n_corners) {
  return "a polygon of " + std::to_string(n_corners) +
         " corners crosses itself too often to be cut up: part of it is a fan";
}

void add_polygon(Scene& scene, std::span<const std::uint32_t> corners, std::span<const std::uint32_t> normals,
                 std::uint32_t material, std::span<const std::array<float, 2>> texcoords) {
  if (corners.size() < 3) return;
  if (corners.size() == 3) return add_triangle(scene, corners, normals, {0, 1, 2}, material, texcoords);
  std::vector<dvec3> points;
  points.reserve(corners.size());
  for (const std::uint32_t c : corners) points.push_back(scene.vertices[c]);
  bool finished = true;
  for (const auto& pick : triangulate(points, &finished))
    add_triangle(scene, corners, normals, pick, material, texcoords);
  if (!finished) scene.warnings.push_back(polygon_warning(points.size()));
}

}  // namespace kdray::scene
