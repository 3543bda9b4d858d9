#include "engine/query/meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "scene/generate/displaced_sphere.h"

namespace kdray::test {

using Face = std::array<std::uint32_t, 3>;

scene::Scene mesh_of(const std::vector<dvec3>& vertices, const std::vector<Face>& triangles) {
  scene::Scene s;
  s.camera = scene::Camera{};
  s.materials.resize(1);
  for (const dvec3& v : vertices) s.vertices.push_back(v);
  for (const Face& f : triangles) {
    scene::Triangle t;
    t.vertex = f;
    t.number = s.primitive_count();
    s.triangles.push_back(t);
  }
  return s;
}

scene::Scene torus(int around, int across) {
  std::vector<dvec3> vertices;
  std::vector<Face> faces;
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>((i % around) * across + j % across);
  };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double phi = 2 * std::numbers::pi * i / around, theta = 2 * std::numbers::pi * j / across;
      const double r = 1 + 0.4 * std::cos(theta);
      vertices.emplace_back(r * std::cos(phi), r * std::sin(phi), 0.4 * std::sin(theta));
      faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh_of(vertices, faces);
}

scene::Scene icosphere(int splits) {
  const double g = std::numbers::phi;
  std::vector<dvec3> v{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                       {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<Face> faces{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                          {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                          {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int i = 0; i < splits; ++i) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(v.size()));
      if (is_new) v.push_back((v[a] + v[b]) / 2.0);
      return place->second;
    };
    std::vector<Face> finer;
    for (const auto& [a, b, c] : faces) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const Face& f : {Face{a, ab, ca}, Face{ab, b, bc}, Face{ca, bc, c}, Face{ab, bc, ca}})
        finer.push_back(f);
    }
    faces.swap(finer);
  }
  for (dvec3& p : v) p = glm::normalize(p);
  return mesh_of(v, faces);
}

scene::Scene cubes(std::uint64_t seed, int side) {
  stress::Random random(seed, 0);
  std::vector<char> full(static_cast<std::size_t>(side * side * side));
  for (char& f : full) f = random.below(2) != 0;
  const auto is_full = [&](int x, int y, int z) {
    const auto in = [&](int k) { return k >= 0 && k < side; };
    return in(x) && in(y) && in(z) && full[static_cast<std::size_t>((z * side + y) * side + x)];
  };
  const auto at = [&](int x, int y, int z) {
    return static_cast<std::uint32_t>((z * (side + 1) + y) * (side + 1) + x);
  };
  std::vector<dvec3> vertices;
  std::vector<Face> faces;
  for (int z = 0; z <= side; ++z)
    for (int y = 0; y <= side; ++y)
      for (int x = 0; x <= side; ++x) vertices.emplace_back(2 * x - side, 2 * y - side, 2 * z - side);
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    faces.push_back({a, b, c}), faces.push_back({a, c, d});
  };
  for (int z = 0; z <= side; ++z)
    for (int y = 0; y <= side; ++y)
      for (int x = 0; x <= side; ++x) {
        const bool here = is_full(x, y, z);
        if (here != is_full(x - 1, y, z))
          quad(at(x, y, z), at(x, y + 1, z), at(x, y + 1, z + 1), at(x, y, z + 1));
        if (here != is_full(x, y - 1, z))
          quad(at(x, y, z), at(x + 1, y, z), at(x + 1, y, z + 1), at(x, y, z + 1));
        if (here != is_full(x, y, z - 1))
          quad(at(x, y, z), at(x + 1, y, z), at(x + 1, y + 1, z), at(x, y + 1, z));
      }
  return mesh_of(vertices, faces);
}

scene::Scene slivers(int n) {
  // Two rails above and two below; strips between the upper ones and the lower ones, and quads at the sides.
  std::vector<dvec3> v;
  std::vector<Face> faces;
  for (int i = 0; i <= n; ++i) {
    const double x = 2e-4 * i - 1e-4 * n;
    for (const dvec3& p :
         {dvec3(x, 0.1, -1), dvec3(x + 1e-4, 0.11, 1), dvec3(x, -0.1, -1), dvec3(x, -0.1, 1)})
      v.push_back(p);
  }
  const auto at = [](int i, int rail) { return static_cast<std::uint32_t>(4 * i + rail); };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    faces.push_back({a, b, c}), faces.push_back({a, c, d});
  };
  for (int i = 0; i < n; ++i) {
    quad(at(i, 0), at(i, 1), at(i + 1, 1), at(i + 1, 0));
    quad(at(i, 2), at(i, 3), at(i + 1, 3), at(i + 1, 2));
    quad(at(i, 0), at(i, 2), at(i + 1, 2), at(i + 1, 0));
    quad(at(i, 1), at(i, 3), at(i + 1, 3), at(i + 1, 1));
  }
  for (const int i : {0, n}) quad(at(i, 0), at(i, 1), at(i, 3), at(i, 2));
  return mesh_of(v, faces);
}

scene::Scene touching() {
  return mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
                 {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 2, 3}, {0, 4, 5}, {0, 5, 6}, {0, 6, 4}, {4, 5, 6}});
}

scene::Scene nested() {
  const scene::Scene cube = stress::cube();
  std::vector<dvec3> v;
  std::vector<Face> faces;
  for (const double scale : {1.0, 0.5, 0.25}) {
    const auto first = static_cast<std::uint32_t>(v.size());
    for (const dvec3& p : cube.vertices) v.push_back(scale * p);
    for (const scene::Triangle& t : cube.triangles)
      faces.push_back({first + t.vertex[0], first + t.vertex[1], first + t.vertex[2]});
  }
  return mesh_of(v, faces);
}

scene::Scene doubled() {
  const std::vector<Face> faces{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 2, 3}};
  std::vector<Face> twice(faces);
  twice.insert(twice.end(), faces.begin(), faces.end());
  return mesh_of({{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, twice);
}

bool edges_are_even(const scene::Scene& scene) {
  using Point = std::array<double, 3>;
  const auto at = [&](const scene::Triangle& t, std::size_t k) {
    const dvec3 v(scene.vertices[t.vertex[k % 3]]);
    return Point{v.x + 0.0, v.y + 0.0, v.z + 0.0};  // -0 is 0
  };
  std::map<std::pair<Point, Point>, int> uses;
  for (const scene::Triangle& t : scene.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Point p = at(t, k), q = at(t, k + 1);
      ++uses[p < q ? std::pair(p, q) : std::pair(q, p)];
    }
  return std::all_of(uses.begin(), uses.end(), [](const auto& use) { return use.second % 2 == 0; });
}

std::vector<NamedMesh> closed_meshes() {
  std::vector<NamedMesh> meshes = stress::small_closed_meshes();
  meshes.push_back({"torus", torus(24, 12)});
  meshes.push_back({"icosphere", icosphere(3)});
  meshes.push_back({"cubes", cubes(7, 6)});
  meshes.push_back({"slivers", slivers(200)});
  meshes.push_back({"touching", touching()});
  meshes.push_back({"nested", nested()});
  meshes.push_back({"doubled", doubled()});
  meshes.push_back({"displaced sphere", generate::displaced_sphere(60)});
  return meshes;
}

}  // namespace kdray::test
