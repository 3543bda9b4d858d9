#include "apps/verify/mesh.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <tuple>

namespace kdray::verify {

namespace {

struct Place {
  vec3 point;
  std::uint32_t vertex;
  auto key() const { return std::tuple(point.x, point.y, point.z); }
};

// The point of each of the file's vertices, as a number; fills `points`. -0 and 0 are one place.
std::vector<std::uint32_t> weld(const scene::Scene& scene, const LocalSpace& space,
                                std::vector<vec3>& points) {
  std::vector<Place> places(scene.vertices.size());
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    places[i] = {vec3(space.local(scene.vertices[i])) + vec3(0.0f), static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(places, [](const Place& a, const Place& b) { return a.key() < b.key(); });
  std::vector<std::uint32_t> point_of(places.size());
  for (const Place& place : places) {
    if (points.empty() || points.back() != place.point) points.push_back(place.point);
    point_of[place.vertex] = static_cast<std::uint32_t>(points.size() - 1);
  }
  return point_of;
}

}  // namespace

dvec3 Mesh::normal(std::size_t triangle) const {
  if (zero_area[triangle] != 0) return dvec3(0);
  const dvec3 a(corner(triangle, 0)), b(corner(triangle, 1)), c(corner(triangle, 2));
  return glm::cross(b - a, c - a);
}

Box Mesh::bounds_of(std::size_t triangle) const {
  Box box;
  for (std::size_t k = 0; k < 3; ++k) box.grow(corner(triangle, k));
  return box;
}

Mesh make_mesh(const scene::Scene& scene, const scene::Geometry& geometry) {
  Mesh mesh;
  const std::vector<std::uint32_t> point_of = weld(scene, geometry.space, mesh.points);
  mesh.triangles.resize(geometry.triangles.size());
  mesh.numbers.resize(geometry.triangles.size());
  tbb::parallel_for(std::size_t{0}, mesh.triangles.size(), [&](std::size_t i) {
    const scene::Triangle& from = scene.triangles[geometry.sources[i]];
    for (std::size_t k = 0; k < 3; ++k) mesh.triangles[i][k] = point_of[from.vertex[k]];
    mesh.numbers[i] = from.number;
  });
  mesh.zero_area.resize(mesh.triangles.size());
  for (const scene::ZeroAreaTriangle& s : geometry.zero_area) mesh.zero_area[s.triangle] = 1;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) mesh.bounds.grow(mesh.bounds_of(i));
  return mesh;
}

}  // namespace kdray::verify
