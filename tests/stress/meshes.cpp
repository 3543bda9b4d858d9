#include "stress/meshes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "layout/tree.layout.h"

namespace kdray::stress {

namespace {

scene::Scene of(const std::vector<dvec3>& vertices,
                const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  scene::Scene s;
  s.camera = scene::Camera{};
  s.materials.resize(1);
  s.materials[0].diffuse = vec3(1);
  for (const dvec3& v : vertices) s.vertices.push_back(v);
  for (const auto& t : triangles) {
    scene::Triangle triangle;
    triangle.vertex = t;
    triangle.number = s.primitive_count();
    s.triangles.push_back(triangle);
  }
  return s;
}

// Rings of `columns` vertices between two poles; radius(i, j) scales the vertex.
scene::Scene rings(int rows, int columns, const std::function<dvec3(int, int)>& vertex) {
  std::vector<dvec3> vertices{vertex(0, 0)};
  for (int i = 1; i < rows; ++i)
    for (int j = 0; j < columns; ++j) vertices.push_back(vertex(i, j));
  vertices.push_back(vertex(rows, 0));
  const auto at = [&](int i, int j) {
    if (i == 0) return 0u;
    if (i == rows) return static_cast<std::uint32_t>(vertices.size() - 1);
    return static_cast<std::uint32_t>(1 + (i - 1) * columns + j % columns);
  };
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      if (i + 1 < rows) triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      if (i > 0) triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return of(vertices, triangles);
}

dvec3 on_sphere(int i, int rows, int j, int columns) {
  const double theta = std::numbers::pi * i / rows, phi = 2 * std::numbers::pi * j / columns;
  return {std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)};
}

dvec3 exactly(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

// The solid angle of a triangle seen from the origin, with sign. Source: van Oosterom and Strackee 1983.
double solid_angle(const dvec3& a, const dvec3& b, const dvec3& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double volume = glm::dot(a, glm::cross(b, c));
  return 2 *
         std::atan2(volume, la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

}  // namespace

scene::Scene cube() {
  std::vector<dvec3> v;
  for (int i = 0; i < 8; ++i) v.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
  return of(v, {{0, 2, 3},
                {0, 3, 1},
                {4, 5, 7},
                {4, 7, 6},
                {0, 1, 5},
                {0, 5, 4},
                {2, 6, 7},
                {2, 7, 3},
                {0, 4, 6},
                {0, 6, 2},
                {1, 3, 7},
                {1, 7, 5}});
}

scene::Scene ball(int rows) {
  return rings(rows, 2 * rows, [&](int i, int j) { return on_sphere(i, rows, j, 2 * rows); });
}

scene::Scene needle() {
  constexpr int kRows = 4, kColumns = 100;
  return rings(kRows, kColumns, [](int i, int j) {
    const dvec3 p = on_sphere(i, kRows, j, kColumns);
    return dvec3(p.x + 0.2 * p.y, 100 * p.y, p.z);
  });
}

scene::Scene crumpled() {
  constexpr int kRows = 20, kColumns = 40;
  return rings(kRows, kColumns, [](int i, int j) {
    Random random(5, static_cast<std::uint64_t>(i * kColumns + j));
    return random.uniform(1, 3) * on_sphere(i, kRows, j, kColumns);
  });
}

std::vector<NamedMesh> small_closed_meshes() {
  std::vector<NamedMesh> all;
  all.push_back({"cube", cube()});
  all.push_back({"ball", ball(32)});
  all.push_back({"needle", needle()});
  all.push_back({"crumpled ball", crumpled()});
  return all;
}

bool is_closed(const scene::Scene& scene) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const scene::Triangle& t : scene.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t.vertex[k], t.vertex[(k + 1) % 3]}];
  return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    const auto back = edges.find({edge.first.second, edge.first.first});
    return back != edges.end() && back->second == edge.second;
  });
}

scene::Scene placed(scene::Scene scene, double scale, const dvec3& offset) {
  for (dvec3& v : scene.vertices) v = scale * v + offset;
  return scene;
}

ClosedMesh::ClosedMesh(scene::Scene scene)
    : prepared_(Scene{std::move(scene)}),
      renderer_(prepared_),
      space_(prepared_.prepared().geometry.space),
      lo_(prepared_.prepared().geometry.bounds.lo),
      hi_(prepared_.prepared().geometry.bounds.hi) {
  for (const layout::KdNode& node : prepared_.prepared().flat.nodes)
    if ((node.word1 & 3u) != KDRAY_NODE_LEAF)
      planes_.push_back({static_cast<int>(node.word1 & 3u), std::bit_cast<float>(node.word0)});
}

dvec3 ClosedMesh::corner(std::size_t triangle, int k) const {
  return exactly(prepared_.prepared().flat.triangles[triangle].v[k]);
}

bool ClosedMesh::to_world(const dvec3& local, vec3* world, dvec3* seen) const {
  const vec3 center(space_.center);
  *world = vec3(space_.world(local));
  const vec3 back = *world - center;
  *seen = dvec3(back) * space_.scale;
  return dvec3(center) == space_.center && space_.local(dvec3(*world)) == *seen;
}

bool ClosedMesh::is_inside(const dvec3& point) const {
  double sum = 0;
  for (std::size_t i = 0; i < triangles(); ++i) {
    const double angle = solid_angle(corner(i, 0) - point, corner(i, 1) - point, corner(i, 2) - point);
    if (std::abs(angle) > 1.999 * std::numbers::pi)
      return false;  // half of all directions: it lies on this triangle
    sum += angle;
  }
  return std::abs(std::abs(sum) / (4 * std::numbers::pi) - 1) < 1e-6;
}

std::vector<Origin> origins_inside(const ClosedMesh& mesh, std::uint64_t seed, std::size_t n,
                                   const std::function<dvec3(Random&, int* axis)>& propose) {
  std::vector<Origin> found(50 * n);
  std::vector<char> good(found.size(), 0);
  const auto one = [&](std::size_t i) {
    Random random(seed, i);
    Origin& o = found[i];
    const dvec3 wanted = propose(random, &o.axis);
    good[i] = mesh.to_world(wanted, &o.world, &o.local) && mesh.is_inside(o.local);
  };
  // Looked for in rounds of n, until there are enough.
  std::vector<Origin> kept;
  for (std::size_t first = 0; first < found.size() && kept.size() < n; first += n) {
    tbb::parallel_for(first, first + n, one);
    for (std::size_t i = first; i < first + n && kept.size() < n; ++i)
      if (good[i]) kept.push_back(found[i]);
  }
  return kept;
}

}  // namespace kdray::stress
