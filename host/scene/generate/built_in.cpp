#include "scene/generate/built_in.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/generate/generate.h"
#include "scene/generate/random.h"
#include "scene/import/load.h"
#include "scene/model/frame.h"

namespace kdray::generate {

// ---- boxes

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

// Returns a room of 20 x 10 x 20 seen from its corner, with a lamp under the ceiling.
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

// ---- lamps

// Returns the room of `boxes` in the evening: four lamps that fade with the distance, a polished shell,
// columns that are mirrors. What depth, least weight and the lights' reach leave out can all be seen.
scene::Scene lamps() {
  constexpr std::size_t kShell = 12, kColumns = 30 * 12;  // the first triangles of boxes()
  scene::Scene scene = boxes();
  scene.name = "lamps";
  scene::Material polished = scene.materials.front(), mirror = polished;
  polished.diffuse = vec3(0.6f, 0.55f, 0.5f), polished.reflect = vec3(0.2f);
  mirror.diffuse = vec3(0.1f), mirror.reflect = vec3(0.8f);
  scene.materials.insert(scene.materials.end(), {polished, mirror});
  for (std::size_t i = 0; i < kShell + kColumns; ++i) scene.triangles[i].material = i < kShell ? 1 : 2;
  scene.lights.clear();
  for (const double x : {-5.0, 5.0})
    for (const double z : {-5.0, 5.0}) {
      scene::Light& lamp = scene.lights.emplace_back();
      lamp.position = {x, 9.5, z};
      lamp.color = vec3(2);
      lamp.attenuation = {1, 0, 0.15f};
    }
  return scene;
}

// ---- spheres

namespace {

// Returns a number in [0, 1) that belongs to a point of the integer lattice.
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

// ---- all of them by name

namespace {

constexpr std::size_t kDisplaced = 1000000;  // triangles

scene::Scene displaced() {
  scene::Scene made = displaced_sphere_of(kDisplaced);
  made.name = "displaced";
  scene::frame_scene(made);
  return made;
}

scene::Scene generated(const Generator& g) {
  std::ostringstream text;
  generate(g.name, g.default_size, text);
  scene::Scene made = scene::read_nff(text.str(), std::string(g.name) + ".nff");
  made.name = g.name;
  scene::frame_scene(made);
  return made;
}

struct BuiltIn {
  std::string name;
  std::function<scene::Scene()> make;
};

const std::vector<BuiltIn>& all_built_in() {
  static const std::vector<BuiltIn> all = [] {
    std::vector<BuiltIn> made = {
        {"boxes", boxes}, {"spheres", spheres}, {"displaced", displaced}, {"lamps", lamps}};
    for (const Generator& g : generators())
      made.push_back({std::string(g.name), [&g] { return generated(g); }});
    return made;
  }();
  return all;
}

// Null where none has that name.
const BuiltIn* find_built_in(const std::string& name) {
  const auto found = std::ranges::find(all_built_in(), name, &BuiltIn::name);
  return found == all_built_in().end() ? nullptr : &*found;
}

}  // namespace

void require_scene(const std::string& name_or_file) {
  if (find_built_in(name_or_file) || std::filesystem::exists(name_or_file)) return;
  std::string known;
  for (const BuiltIn& b : all_built_in()) known.append(known.empty() ? "" : " ").append(b.name);
  throw input_error(name_or_file, 0, "neither a file nor a built-in scene", "built in are " + known);
}

scene::Scene load_scene(const std::string& name_or_file) {
  if (const BuiltIn* const b = find_built_in(name_or_file)) return b->make();
  require_scene(name_or_file);
  return scene::load(name_or_file);
}

}  // namespace kdray::generate
