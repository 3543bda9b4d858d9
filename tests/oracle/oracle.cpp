#include "oracle/oracle.h"

#include <algorithm>
#include <cmath>
#include <thread>

namespace kdray::oracle {
namespace {

constexpr double kAside = 5e-3;  // pixels; float rounding moves a primary ray by far less

// Where the ray of pixel i crosses the picture, in pixels from its edge.
double position(int i, int n, Grid grid) {
  if (grid == Grid::centers) return i + 0.5;
  return n > 1 ? static_cast<double>(i) * n / (n - 1) : 0.5 * n;
}

void trace_row(const Whitted& whitted, const scene::Camera& camera, Grid grid, int row, OracleResult& out,
               RayCounts& counts) {
  const double y = position(row, out.height, grid);
  for (int column = 0; column < out.width; ++column) {
    const double x = position(column, out.width, grid);
    const std::size_t pixel = static_cast<std::size_t>(row) * out.width + column;
    Path path;
    const dvec3 color = whitted.trace_eye(eye_ray(camera, x, y, out.width, out.height), path, counts);
    out.rgb[pixel] = color;
    for (const double dx : {-kAside, kAside}) {
      for (const double dy : {-kAside, kAside}) {
        Path aside;
        RayCounts ignored;
        const Ray ray = eye_ray(camera, x + dx, y + dy, out.width, out.height);
        const dvec3 moved = glm::abs(whitted.trace_eye(ray, aside, ignored) - color);
        out.spread[pixel] = std::max({out.spread[pixel], moved.x, moved.y, moved.z});
        if (aside != path) out.edge[pixel] = 1;
      }
    }
  }
}

}  // namespace

Ray eye_ray(const scene::Camera& camera, double x, double y, int width, int height) {
  const dvec3 forward = glm::normalize(camera.at - camera.from);
  const dvec3 right = glm::normalize(glm::cross(forward, camera.up));
  const dvec3 up = glm::cross(right, forward);
  const double half_height = std::tan(camera.vertical_fov / 2);
  const double half_width = half_height * width / height;
  Ray ray;
  ray.origin = camera.from;
  ray.direction = glm::normalize(forward + (2 * x / width - 1) * half_width * right +
                                 (1 - 2 * y / height) * half_height * up);
  ray.t_min = camera.hither / glm::dot(ray.direction, forward);
  return ray;
}

OracleResult trace_picture(const scene::Scene& scene, int width, int height, int depth, Grid grid) {
  const Whitted whitted(scene, depth);
  const std::size_t pixels = static_cast<std::size_t>(width) * height;
  OracleResult out{width,
                   height,
                   std::vector<dvec3>(pixels),
                   std::vector<std::uint8_t>(pixels),
                   std::vector<double>(pixels),
                   {}};
  // Rows are independent: thread i takes every n-th of them.
  const int n = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<RayCounts> counts(n);
  std::vector<std::thread> threads;
  for (int i = 0; i < n; ++i) {
    threads.emplace_back([&, i] {
      for (int row = i; row < height; row += n) trace_row(whitted, *scene.camera, grid, row, out, counts[i]);
    });
  }
  for (std::thread& t : threads) t.join();
  for (const RayCounts& c : counts) out.counts += c;
  return out;
}

}  // namespace kdray::oracle
