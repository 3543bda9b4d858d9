// What    A displaced sphere of about any number of triangles: a closed mesh to measure and to test with.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "scene/generate/random.h"
#include "scene/model/scene.h"

namespace kdray::generate {

// Adds a triangle to a mesh that is being made, numbered in the order of the calls.
inline void add_triangle(scene::Scene& scene, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  scene::Triangle t;
  t.vertex = {a, b, c};
  t.number = static_cast<std::uint32_t>(scene.triangles.size());
  scene.triangles.push_back(t);
}

// Returns one of about 2*n*n triangles, whose radius varies by a fifth.
inline scene::Scene displaced_sphere(std::uint32_t n) {
  scene::Scene s;
  const std::uint32_t columns = 2 * n, rows = n / 2 + 1;
  for (std::uint32_t y = 0; y <= rows; ++y)
    for (std::uint32_t x = 0; x < columns; ++x) {
      const double theta = std::numbers::pi * y / rows, phi = 2 * std::numbers::pi * x / columns;
      // The poles are points: the mesh is closed.
      const double across = y == 0 || y == rows ? 0 : std::sin(theta);
      const double ripple =
          0.2 * std::sin(9 * theta) * std::sin(11 * phi) + 0.02 * std::sin(90 * theta + 70 * phi);
      const double r = 1 + across * ripple;
      s.vertices.emplace_back(r * across * std::cos(phi), r * across * std::sin(phi), r * std::cos(theta));
    }
  for (std::uint32_t y = 0; y < rows; ++y)
    for (std::uint32_t x = 0; x < columns; ++x) {
      const std::uint32_t a = y * columns + x, b = y * columns + (x + 1) % columns;
      if (y > 0) add_triangle(s, a, b, a + columns);
      if (y + 1 < rows) add_triangle(s, b, b + columns, a + columns);
    }
  s.materials.emplace_back();
  s.materials[0].diffuse = vec3(0.7f);
  return s;
}

// Returns the smallest one that has at least so many triangles.
inline scene::Scene displaced_sphere_of(std::size_t n_triangles) {
  const auto triangles = [](std::uint32_t n) { return std::size_t{4} * n * (n / 2); };
  auto n = static_cast<std::uint32_t>(std::max(2.0, std::sqrt(static_cast<double>(n_triangles) / 2)));
  while (triangles(n) < n_triangles) ++n;
  return displaced_sphere(n);
}

}  // namespace kdray::generate
