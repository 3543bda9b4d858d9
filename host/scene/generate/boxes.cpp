#include <array>
#include <cmath>
#include <numbers>

#include "scene/generate/add_triangle.h"
#include "scene/generate/built_in.h"
#include "scene/generate/random.h"

namespace kdray::generate {

namespace {

// The corners of each face, as bits: 1 right, 2 up, 4 back.
constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces = {
    {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};

// Twelve triangles; turned by `angle` about the vertical.
void add_box(scene::Scene& scene, const dvec3& center, const dvec3& half, double angle) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  const double c = std::cos(angle), s = std::sin(angle);
  for (int i = 0; i < 8; ++i) {
    const dvec3 p = half * dvec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    scene.vertices.push_back(center + dvec3(p.x * c - p.z * s, p.y, p.x * s + p.z * c));
  }
  for (const auto& face : kFaces) {
    add_triangle(scene, first + face[0], first + face[1], first + face[2]);
    add_triangle(scene, first + face[0], first + face[2], first + face[3]);
  }
}

// Boxes from thin slats to blocks about one place of the room, every third along the axes.
void add_heap(scene::Scene& scene, Random& random) {
  constexpr int kBoxes = 160;
  const double height = random.unit() * random.unit();
  const dvec3 center(random.between(-9, 9), 9 * height, random.between(-9, 9));
  const double size = random.between(0.3, 1.5);
  for (int i = 0; i < kBoxes; ++i) {
    dvec3 p = center + size * random.in_box(dvec3(-0.5), dvec3(0.5));
    p.y = std::max(p.y, 0.05);
    const double small = random.unit(), thin = random.unit();
    const double h = size * (0.01 + 0.06 * small * small);
    const dvec3 half = h * dvec3(0.5 + 2 * thin * thin, random.between(0.5, 1.5), 1);
    const double angle = random.between(0, 2 * std::numbers::pi);
    add_box(scene, p, half, i % 3 == 0 ? 0 : angle);
  }
}

}  // namespace

// A room of 20 x 10 x 20 seen from its corner, with a lamp under the ceiling.
scene::Scene boxes() {
  constexpr int kColumns = 30, kHeaps = 160;
  Random random(7);
  scene::Scene scene;
  scene.name = "boxes";
  add_box(scene, {0, 5, 0}, {10, 5, 10}, 0);
  for (int i = 0; i < kColumns; ++i) {
    const dvec3 place(random.between(-9, 9), 5, random.between(-9, 9));
    const double angle = random.between(0, std::numbers::pi);
    add_box(scene, place, {0.15, 5, 0.15}, i % 2 == 0 ? angle : 0);
  }
  for (int i = 0; i < kHeaps; ++i) add_heap(scene, random);
  scene.materials.emplace_back().diffuse = vec3(0.7f);
  scene.lights.emplace_back().position = {0, 9.5, 0.3};
  scene.camera = {
      .from = {-9, 6, -9}, .at = {2, 2.5, 2}, .up = {0, 1, 0}, .vertical_fov = 65 * std::numbers::pi / 180};
  return scene;
}

}  // namespace kdray::generate
