// What    The outdoor scene of workload/scenes.h.

#include <cmath>
#include <memory>
#include <numbers>

#include "bench/workload/scenes.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/generate/random.h"
#include "scene/generate/rotation.h"

namespace kdray::bench {

namespace {

using generate::add_triangle;
using generate::Random;

constexpr double kHalf = 40;  // of the ground's side
enum Material : std::uint32_t { soil, leaf, bark };

double height(double x, double z) {
  return 0.7 * std::sin(0.21 * x + 1) * std::cos(0.17 * z) + 0.15 * std::sin(1.1 * x) * std::sin(0.9 * z + 2);
}

std::uint32_t add_vertex(scene::Scene& s, const dvec3& p) {
  s.vertices.push_back(p);
  return static_cast<std::uint32_t>(s.vertices.size() - 1);
}

void add(scene::Scene& s, Material material, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  add_triangle(s, a, b, c);
  s.triangles.back().material = material;
}

// 20,000 triangles.
void add_ground(scene::Scene& s) {
  constexpr std::uint32_t n = 100;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = kHalf * (2.0 * i / n - 1), z = kHalf * (2.0 * j / n - 1);
      add_vertex(s, {x, height(x, z), z});
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, below = a + n + 1;
      add(s, soil, a, below, a + 1);
      add(s, soil, a + 1, below, below + 1);
    }
}

// A blade that bends over: a strip which ends in a point.
void add_blade(scene::Scene& s, Random& random) {
  constexpr int kSegments = 4;
  const double angle = random.between(0, 2 * std::numbers::pi), length = random.between(0.25, 0.6);
  const dvec3 out(std::cos(angle), 0, std::sin(angle)), side(-out.z, 0, out.x);
  const dvec3 root(random.between(-0.15, 0.15), 0, random.between(-0.15, 0.15));
  const double bend = random.between(0.1, 0.9);
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (int i = 0; i < kSegments; ++i) {
    const double t = static_cast<double>(i) / kSegments, width = 0.008 * (1 - t);
    const dvec3 p = root + length * (t * dvec3(0, 1, 0) + bend * t * t * (out - dvec3(0, 0.4, 0)));
    add_vertex(s, p - width * side);
    add_vertex(s, p + width * side);
  }
  const std::uint32_t tip = add_vertex(s, root + length * (dvec3(0, 1, 0) + bend * (out - dvec3(0, 0.4, 0))));
  for (std::uint32_t a = first; a + 2 < tip; a += 2) {
    add(s, leaf, a, a + 1, a + 2);
    add(s, leaf, a + 1, a + 3, a + 2);
  }
  add(s, leaf, tip - 2, tip - 1, tip);
}

// A lozenge, folded along its middle.
void add_leaf(scene::Scene& s, Random& random, const dvec3& at, double size) {
  const dvec3 along = random.direction();
  const dvec3 side = glm::normalize(glm::cross(along, random.direction() + 1e-6));
  const dvec3 up = glm::cross(side, along);
  const std::uint32_t a = add_vertex(s, at), b = add_vertex(s, at + size * along);
  const dvec3 middle = at + 0.5 * size * along + 0.1 * size * up;
  const std::uint32_t c = add_vertex(s, middle + 0.3 * size * side),
                      d = add_vertex(s, middle - 0.3 * size * side);
  add(s, leaf, a, c, b);
  add(s, leaf, a, b, d);
}

void add_branch(scene::Scene& s, const dvec3& from, const dvec3& to, double thick, double thin) {
  constexpr std::uint32_t kSides = 6;
  const dvec3 way = glm::normalize(to - from);
  const dvec3 side = glm::normalize(glm::cross(way, std::abs(way.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0)));
  const dvec3 other = glm::cross(way, side);
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    const dvec3 out = std::cos(angle) * side + std::sin(angle) * other;
    add_vertex(s, from + thick * out);
    add_vertex(s, to + thin * out);
  }
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % kSides);
    add(s, bark, a, b, a + 1);
    add(s, bark, b, b + 1, a + 1);
  }
}

// Three branches grow out of each, and leaves around the last ones.
void grow(scene::Scene& s, Random& random, const dvec3& from, const dvec3& way, double length, int levels) {
  constexpr int kBranches = 3, kLeaves = 24;
  const dvec3 to = from + length * way;
  add_branch(s, from, to, 0.06 * length, 0.035 * length);
  if (levels == 0) {
    for (int i = 0; i < kLeaves; ++i)
      add_leaf(s, random, to + 0.8 * length * random.in_box(dvec3(-1), dvec3(1)), 0.13);
    return;
  }
  for (int i = 0; i < kBranches; ++i) {
    const dvec3 turned = glm::normalize(way + 0.75 * random.direction() + dvec3(0, 0.15, 0));
    grow(s, random, from + random.between(0.6, 1) * length * way, turned, random.between(0.6, 0.8) * length,
         levels - 1);
  }
}

scene::Scene tuft(Random& random) {
  constexpr int kBlades = 60;
  scene::Scene s;
  s.name = "tuft";
  for (int i = 0; i < kBlades; ++i) add_blade(s, random);
  return s;
}

scene::Scene shrub(Random& random) {
  constexpr int kLeaves = 700;
  scene::Scene s;
  s.name = "shrub";
  for (int i = 0; i < kLeaves; ++i) {
    const dvec3 out = random.direction();
    add_leaf(s, random, dvec3(0, 0.5, 0) + dvec3(0.7, 0.5, 0.7) * (random.between(0.6, 1) * out), 0.12);
  }
  return s;
}

scene::Scene tree(Random& random) {
  scene::Scene s;
  s.name = "tree";
  grow(s, random, dvec3(0, -0.3, 0), dvec3(0, 1, 0), 2.4, 4);
  return s;
}

// Sown evenly, each turned about the vertical and scaled.
void sow(scene::Scene& s, Random& random, scene::Scene plant, int n, double least, double most) {
  const auto mesh = static_cast<std::uint32_t>(s.meshes.size());
  s.meshes.push_back(std::make_shared<scene::Scene>(std::move(plant)));
  for (int i = 0; i < n; ++i) {
    const double x = random.between(-kHalf, kHalf), z = random.between(-kHalf, kHalf);
    scene::Instance instance;
    instance.mesh = mesh;
    instance.linear =
        random.between(least, most) * generate::rotation_y(random.between(0, 2 * std::numbers::pi));
    instance.move = {x, height(x, z), z};
    s.instances.push_back(instance);
  }
}

}  // namespace

scene::Scene meadow() {
  constexpr std::uint64_t kSeed = 43;
  Random random(kSeed);
  scene::Scene s;
  s.name = "meadow";
  s.materials.resize(3);
  s.materials[soil].diffuse = {0.35f, 0.25f, 0.15f};
  s.materials[leaf].diffuse = {0.25f, 0.5f, 0.12f};
  s.materials[bark].diffuse = {0.4f, 0.3f, 0.2f};
  add_ground(s);
  sow(s, random, tuft(random), 3000, 0.8, 2);
  sow(s, random, shrub(random), 300, 0.6, 1.4);
  sow(s, random, tree(random), 160, 0.7, 1.3);
  s.lights.emplace_back().position = {60, 90, -45};
  s.background = {0.5f, 0.65f, 0.85f};
  const double x = -17, z = -17;
  s.camera = {.from = {x, height(x, z) + 1.7, z},
              .at = {0, 2, 0},
              .up = {0, 1, 0},
              .vertical_fov = 60 * std::numbers::pi / 180};
  return s;
}

}  // namespace kdray::bench
