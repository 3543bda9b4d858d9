#include <cmath>
#include <numbers>

#include "scene/generate/add_triangle.h"
#include "scene/generate/built_in.h"
#include "scene/generate/random.h"

namespace kdray::generate {

namespace {

// A number in [0, 1) that belongs to a point of the integer lattice.
double lattice_value(const dvec3& p) {
  std::uint64_t key = 0;
  for (int k = 0; k < 3; ++k)
    key = key * 0x100000001b3u + static_cast<std::uint64_t>(static_cast<std::int64_t>(p[k]));
  return Random(key).unit();
}

// Values of the lattice, smoothly interpolated.
double noise(const dvec3& p) {
  const dvec3 cell = glm::floor(p), inside = p - cell;
  const dvec3 weight = inside * inside * (3.0 - 2.0 * inside);
  double sum = 0;
  for (int i = 0; i < 8; ++i) {
    const dvec3 corner(i & 1, (i >> 1) & 1, i >> 2);
    const dvec3 share = corner * weight + (1.0 - corner) * (1.0 - weight);
    sum += share.x * share.y * share.z * lattice_value(cell + corner);
  }
  return sum;
}

struct Ball {
  dvec3 center;
  double radius, displacement, frequency;
  std::uint32_t columns, rows;
};

// 2 * columns * (rows - 1) triangles; at the poles a row's corners are one point.
void add_ball(scene::Scene& scene, const Ball& ball) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (std::uint32_t y = 0; y <= ball.rows; ++y)
    for (std::uint32_t x = 0; x < ball.columns; ++x) {
      const double theta = std::numbers::pi * y / ball.rows, phi = 2 * std::numbers::pi * x / ball.columns;
      const double across = y == 0 || y == ball.rows ? 0 : std::sin(theta);
      const dvec3 out(across * std::cos(phi), std::cos(theta), across * std::sin(phi));
      const dvec3 q = out * ball.frequency + ball.center;
      const double bumps =
          noise(q) + 0.5 * noise(q * 2.1) + 0.25 * noise(q * 4.3) + 0.12 * noise(q * 9.1) - 0.9;
      scene.vertices.push_back(ball.center + out * (ball.radius * (1 + ball.displacement * bumps)));
    }
  for (std::uint32_t y = 0; y < ball.rows; ++y)
    for (std::uint32_t x = 0; x < ball.columns; ++x) {
      const std::uint32_t a = first + y * ball.columns + x,
                          b = first + y * ball.columns + (x + 1) % ball.columns;
      if (y > 0) add_triangle(scene, a, b, a + ball.columns);
      if (y + 1 < ball.rows) add_triangle(scene, b, b + ball.columns, a + ball.columns);
    }
}

// A square of 2 * n * n triangles.
void add_ground(scene::Scene& scene, double half, double level, double height, std::uint32_t n) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = half * (2.0 * i / n - 1), z = half * (2.0 * j / n - 1);
      scene.vertices.emplace_back(x, level + height * (noise({0.7 * x, 3.3, 0.7 * z}) - 0.5), z);
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = first + j * (n + 1) + i, below = a + n + 1;
      add_triangle(scene, a, a + 1, below);
      add_triangle(scene, a + 1, below + 1, below);
    }
}

}  // namespace

scene::Scene spheres() {
  scene::Scene scene;
  scene.name = "spheres";
  add_ball(scene, {{0, 1.6, 0}, 2.2, 0.25, 1.7, 700, 500});
  add_ball(scene, {{4.2, 0.7, 1.5}, 1.2, 0.3, 2.5, 200, 150});
  add_ball(scene, {{-3.6, 0.8, 2.2}, 1.3, 0.15, 4, 200, 150});
  add_ground(scene, 14, -1, 0.5, 200);
  scene.materials.emplace_back().diffuse = vec3(0.7f);
  scene.lights.emplace_back().position = {8, 12, 6};
  scene.camera = {
      .from = {3, 4.2, 9}, .at = {0, 0.6, 0}, .up = {0, 1, 0}, .vertical_fov = 45 * std::numbers::pi / 180};
  return scene;
}

}  // namespace kdray::generate
