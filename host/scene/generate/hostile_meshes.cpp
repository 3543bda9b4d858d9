#include "scene/generate/hostile_meshes.h"

#include <array>
#include <cmath>
#include <numbers>

#include "scene/generate/displaced_sphere.h"
#include "scene/generate/random.h"

namespace kdray::generate {

namespace {

scene::Scene empty_mesh() {
  scene::Scene scene;
  scene.materials.emplace_back().diffuse = vec3(0.7f);
  return scene;
}

void add(scene::Scene& scene, const dvec3& a, const dvec3& b, const dvec3& c) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  scene.vertices.insert(scene.vertices.end(), {a, b, c});
  add_triangle(scene, first, first + 1, first + 2);
}

dvec3 in_cube(Random& random, double half) {
  return random.in_box(dvec3(-half), dvec3(half));
}

// Small triangles strewn over a unit square's neighbourhood, each about as large as its share of it.
scene::Scene strewn(std::uint32_t n, const dvec3& across, const dvec3& up) {
  Random random(31);
  scene::Scene scene = empty_mesh();
  const double size = 2 / std::sqrt(static_cast<double>(n));
  const auto place = [&](double x, double y) { return across * x + up * y; };
  for (std::uint32_t i = 0; i < n; ++i) {
    const double x = random.between(-1, 1), y = random.between(-1, 1);
    std::array<dvec3, 3> corner;
    for (dvec3& c : corner) {
      const double dx = random.between(-size, size), dy = random.between(-size, size);
      c = place(x + dx, y + dy);
    }
    add(scene, corner[0], corner[1], corner[2]);
  }
  return scene;
}

scene::Scene coplanar(std::uint32_t n) {
  return strewn(n, {1, 0, 0}, {0, 0, 1});
}

scene::Scene tilted(std::uint32_t n) {
  return strewn(n, {1, 0, 1}, {0, 1, 1});
}

scene::Scene same(std::uint32_t n) {
  scene::Scene scene = empty_mesh();
  scene.vertices = {{0, 0, 0}, {1, 0, 0.25}, {0, 1, 0.5}};
  for (std::uint32_t i = 0; i < n; ++i) add_triangle(scene, 0, 1, 2);
  return scene;
}

// The origin is the bounds' centre, so that what is near it keeps its bits.
void add_frame(scene::Scene& scene) {
  add(scene, {-1, -1, -1}, {1, -1, 1}, {1, 1, 1});
}

scene::Scene point(std::uint32_t n) {
  Random random(32);
  scene::Scene scene = empty_mesh();
  add_frame(scene);
  for (std::uint32_t i = 1; i < n; ++i) {
    const dvec3 a = in_cube(random, 0x1p-30), b = in_cube(random, 0x1p-30), c = in_cube(random, 0x1p-30);
    add(scene, a, b, c);
  }
  return scene;
}

// Needles of any direction, from anywhere in a cube of 2, and `width` across.
scene::Scene needles_of(std::uint32_t n, double length, double width, std::uint64_t seed) {
  Random random(seed);
  scene::Scene scene = empty_mesh();
  for (std::uint32_t i = 0; i < n; ++i) {
    const dvec3 a = in_cube(random, 1), along = random.direction(), aside = random.direction();
    const dvec3 across = glm::cross(along, aside);
    add(scene, a, a + along * length, a + across * (width / glm::length(across)));
  }
  return scene;
}

scene::Scene slivers(std::uint32_t n) {
  return needles_of(n, 0.25, 0.25e-6, 33);
}

scene::Scene needles(std::uint32_t n) {
  return needles_of(n, 1, 1e-3, 34);
}

scene::Scene huge(std::uint32_t n) {
  Random random(35);
  scene::Scene scene = empty_mesh();
  add(scene, {-1000, -1000, -0.3}, {1000, -1000, 0.2}, {0, 1000, 0.1});
  const double size = 1 / std::cbrt(static_cast<double>(n));
  for (std::uint32_t i = 1; i < n; ++i) {
    const dvec3 p = in_cube(random, 1);
    const dvec3 a = p + in_cube(random, size), b = p + in_cube(random, size), c = p + in_cube(random, size);
    add(scene, a, b, c);
  }
  return scene;
}

// Returns a mesh in which 60% of the triangles have two equal corners.
scene::Scene degenerate(std::uint32_t n) {
  scene::Scene scene = displaced_sphere_of(n);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i)
    if (i % 5 < 3) scene.triangles[i].vertex[1] = scene.triangles[i].vertex[0];
  return scene;
}

// Returns a wavy disc of triangles that all have the middle as a corner.
scene::Scene fan(std::uint32_t n) {
  scene::Scene scene = empty_mesh();
  scene.vertices.emplace_back(0, 0, 0);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    scene.vertices.emplace_back(std::cos(angle), 0.1 * std::sin(9 * angle), std::sin(angle));
    add_triangle(scene, 0, i + 1, (i + 1) % n + 1);
  }
  return scene;
}

constexpr std::array<HostileMesh, 9> kMeshes = {{
    {"coplanar", "all in one plane across an axis, overlapping", coplanar},
    {"tilted", "all in one plane at an angle, overlapping", tilted},
    {"same", "one triangle, over and over", same},
    {"point", "all but one within 2^-30 of a point", point},
    {"slivers", "a million times as long as wide, an eighth of the scene long", slivers},
    {"huge", "one huge and all others tiny", huge},
    {"degenerate", "60% have two corners in one", degenerate},
    {"fan", "all have one corner in common", fan},
    {"needles", "a thousand times as long as wide, half of the scene long", needles},
}};

}  // namespace

std::span<const HostileMesh> hostile_meshes() {
  return kMeshes;
}

std::span<const std::string_view> hostile_names() {
  static constexpr auto names = [] {
    std::array<std::string_view, kMeshes.size()> all;
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = kMeshes[i].name;
    return all;
  }();
  return names;
}

}  // namespace kdray::generate
