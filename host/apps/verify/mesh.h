// What    The triangles of a scene as a mesh: corners at one place are one point, whatever the file says.
//         Places are those that rays see (float, about the scene's centre), so that a seam that is closed
//         here is closed to every ray.
// Shape   Triangles keep Geometry's order: triangle i here is Geometry::triangles[i]. Degenerate ones are not
//         among them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::verify {

using Corners = std::array<std::uint32_t, 3>;  // into Mesh::points

struct Mesh {
  std::vector<vec3> points;             // all different
  std::vector<Corners> triangles;       // corners
  std::vector<std::uint32_t> numbers;   // of each triangle, in file order over all kinds of primitives
  std::vector<std::uint8_t> zero_area;  // of each: 1 where it has no area (scene/model/zero_area.h)
  Box bounds;                           // of the points

  const vec3& corner(std::size_t triangle, std::size_t k) const { return points[triangles[triangle][k]]; }
  // Twice the area long; from the front, counter-clockwise. 0 where it has no area, whatever rounding says.
  dvec3 normal(std::size_t triangle) const;
  Box bounds_of(std::size_t triangle) const;
};

Mesh make_mesh(const scene::Scene& scene, const scene::Geometry& geometry);

}  // namespace kdray::verify
