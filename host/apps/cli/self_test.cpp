#include "apps/cli/self_test.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kdray/kdray.h"
#include "probe/trial/trial.h"
#include "scene/model/scene.h"

namespace kdray::cli {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A unit sphere at the origin before a triangle in the plane z = -2, seen from (0, 0, 5), a light at the eye.
scene::Scene make_scene() {
  scene::Scene scene;
  scene.name = "self-test";
  scene.materials = {scene::Material{.ambient = vec3(0.1f), .diffuse = vec3(0.8f)}};
  scene.vertices = {{-40, -40, -2}, {40, -40, -2}, {0, 40, -2}};
  scene.triangles = {scene::Triangle{.vertex = {0, 1, 2}, .material = 0, .number = 0}};
  scene.spheres = {scene::Sphere{.center = dvec3(0), .radius = 1, .material = 0, .number = 1}};
  scene.lights = {scene::Light{.position = dvec3(0, 0, 5)}};
  scene.camera = scene::Camera{};
  return scene;
}

struct Case {
  Ray ray;
  float t;
  std::int32_t primitive;
};

// Straight at the sphere; past it at the triangle; away from both.
const std::array<Case, 3> kCases = {{{{{0, 0, 5}, 0, {0, 0, -1}, kInfinity}, 4, 1},
                                     {{{0, 1.5f, 5}, 0, {0, 0, -2}, kInfinity}, 3.5f, 0},
                                     {{{0, 0, 5}, 0, {0, 0, 1}, kInfinity}, kInfinity, -1}}};

std::string check_hits(Renderer& renderer) {
  std::vector<Ray> rays;
  for (const Case& c : kCases) rays.push_back(c.ray);
  const std::vector<Hit> hits = renderer.trace(rays);
  for (std::size_t i = 0; i < kCases.size(); ++i) {
    const bool same_t =
        std::isinf(kCases[i].t) ? std::isinf(hits[i].t) : std::abs(hits[i].t - kCases[i].t) < 1e-4f;
    if (!same_t || hits[i].primitive != kCases[i].primitive)
      return fmt::format("ray {} should hit primitive {} at t = {}, but hits {} at {}", i,
                         kCases[i].primitive, kCases[i].t, hits[i].primitive, hits[i].t);
  }
  return "";
}

// The sphere's middle faces light and eye: 0.1 ambient + 0.8 diffuse, but for the half pixel off the axis.
std::string check_picture(Renderer& renderer) {
  constexpr int kSide = 33;
  const Picture picture = renderer.render({.width = kSide, .height = kSide, .depth = 1});
  const float middle = picture.rgb[3 * (kSide / 2 * kSide + kSide / 2)];
  if (!(std::abs(middle - 0.9f) < 1e-3f)) return fmt::format("a pixel should be 0.9, but is {}", middle);
  return "";
}

}  // namespace

std::string self_test(const std::string& device) {
  Renderer renderer(Scene(make_scene()), {}, {.device = device});
  if (const std::string wrong = check_hits(renderer); !wrong.empty()) return wrong;
  return check_picture(renderer);
}

void try_if_asked(int argc, char** argv) {
  trial::this_program_tries();
  if (const auto request = trial::request_of({argv, static_cast<std::size_t>(argc)}))
    trial::try_it(*request, [](int number) { return self_test(std::to_string(number)); });
}

}  // namespace kdray::cli
