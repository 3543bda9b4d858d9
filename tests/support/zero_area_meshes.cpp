#include "support/zero_area_meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

namespace kdray::test {

namespace {

using Point = std::array<std::int64_t, 3>;

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

class Divider {
 public:
  Divider(LatticeMesh& mesh, unsigned seed) : mesh_(mesh), random_(seed) {
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) number_of_.emplace(mesh.vertices[i], i);
  }

  void divide(std::size_t n) {
    for (std::size_t attempts = 20 * n; attempts > 0 && n > 0; --attempts) n -= divide_one() ? 1 : 0;
  }

 private:
  bool divide_one() {
    const std::size_t t = random_() % mesh_.triangles.size(), k = random_() % 3;
    const std::array<std::uint32_t, 3> corners = mesh_.triangles[t];
    const std::uint32_t x = corners[k], y = corners[(k + 1) % 3], z = corners[(k + 2) % 3];
    const Point from = mesh_.vertices[x], way = minus(mesh_.vertices[y], from);
    const std::int64_t parts = std::gcd(std::gcd(way[0], way[1]), way[2]);
    if (parts < 2) return false;
    const std::int64_t part = 1 + static_cast<std::int64_t>(random_()) % (parts - 1);
    const std::uint32_t m = number_of(
        {from[0] + way[0] / parts * part, from[1] + way[1] / parts * part, from[2] + way[2] / parts * part});
    if (m == z) return false;
    mesh_.triangles[t] = {x, m, z};
    mesh_.triangles.push_back({m, y, z});
    mesh_.triangles.push_back({x, y, m});
    return true;
  }

  // Corners in one place are one.
  std::uint32_t number_of(const Point& p) {
    const auto [found, is_new] = number_of_.emplace(p, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(p);
    return found->second;
  }

  LatticeMesh& mesh_;
  std::mt19937 random_;
  std::map<Point, std::uint32_t> number_of_;
};

// Its upper side goes through the origin, as a floor does: rays that leave it are hardly moved off.
LatticeMesh box_below_the_origin(std::int64_t step) {
  LatticeMesh box = lattice_box(step);
  for (Point& p : box.vertices) p[1] -= 2 * step;
  box.name += " below the origin";
  return box;
}

LatticeMesh divided(LatticeMesh mesh, std::size_t n, unsigned seed) {
  divide_edges(mesh, n, seed);
  mesh.name += ", " + std::to_string(n) + " edges divided";
  return mesh;
}

}  // namespace

bool LatticeMesh::has_area(std::size_t triangle) const {
  const auto& [a, b, c] = triangles[triangle];
  const Point e = minus(vertices[b], vertices[a]), f = minus(vertices[c], vertices[a]);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (e[i] * f[j] != e[j] * f[i]) return true;
  }
  return false;
}

std::size_t LatticeMesh::n_without_area() const {
  std::size_t n = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) n += has_area(i) ? 0 : 1;
  return n;
}

LatticeMesh lattice_box(std::int64_t step) {
  LatticeMesh mesh;
  mesh.name = "box";
  for (int i = 0; i < 8; ++i) {
    const auto at = [&](int bit, std::int64_t size) { return (i & bit) != 0 ? size * step : -size * step; };
    mesh.vertices.push_back({at(1, 1), at(2, 2), at(4, 3)});
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

LatticeMesh lattice_ball(int rows, std::int64_t radius, std::int64_t step, unsigned seed) {
  const int columns = 2 * rows;
  std::mt19937 random(seed);
  LatticeMesh mesh;
  mesh.name = "ball of " + std::to_string(rows) + " rows";
  const auto add = [&](int i, int j) {
    const double theta = std::numbers::pi * i / rows, phi = 2 * std::numbers::pi * j / columns;
    const double r = static_cast<double>(radius) * (1 + 2 * (static_cast<double>(random()) * 0x1p-32)) / 3;
    const dvec3 p =
        r * dvec3(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
    mesh.vertices.push_back({std::llround(p.x) * step, std::llround(p.y) * step, std::llround(p.z) * step});
  };
  add(0, 0);
  for (int i = 1; i < rows; ++i)
    for (int j = 0; j < columns; ++j) add(i, j);
  add(rows, 0);
  const auto at = [&](int i, int j) {
    if (i == 0) return 0u;
    if (i == rows) return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    return static_cast<std::uint32_t>(1 + (i - 1) * columns + j % columns);
  };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      if (i + 1 < rows) mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      if (i > 0) mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

void divide_edges(LatticeMesh& mesh, std::size_t n, unsigned seed) {
  Divider(mesh, seed).divide(n);
}

std::vector<LatticeMesh> zero_area_meshes() {
  std::vector<LatticeMesh> all;
  all.push_back(divided(lattice_box(60), 40, 1));
  all.push_back(divided(lattice_box(2 * 1000 * 1000), 600, 2));
  all.push_back(divided(box_below_the_origin(1000 * 1000), 600, 6));
  all.push_back(divided(lattice_ball(6, 20, 12, 3), 300, 3));
  all.push_back(divided(lattice_ball(16, 1 << 15, 1 << 7, 4), 1200, 4));
  all.push_back(divided(lattice_ball(24, 1 << 11, 1 << 11, 5), 500, 5));
  return all;
}

scene::Scene scene_of(const LatticeMesh& mesh, double scale, const dvec3& offset) {
  scene::Scene s;
  s.name = mesh.name;
  s.camera = scene::Camera{};
  s.materials.resize(1);
  s.materials[0].diffuse = vec3(1);
  for (const Point& p : mesh.vertices)
    s.vertices.push_back(
        scale * dvec3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])) +
        offset);
  for (const auto& corners : mesh.triangles) {
    scene::Triangle t;
    t.vertex = corners;
    t.number = s.primitive_count();
    s.triangles.push_back(t);
  }
  return s;
}

}  // namespace kdray::test
