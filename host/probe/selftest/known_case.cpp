#include "probe/selftest/known_case.h"

#include <limits>

namespace kdray::selftest {

namespace {

constexpr int kAcross = 8, kDown = 6;

constexpr std::array kAnswers = std::to_array<Answer>({
#include "probe/selftest/known_answers.inc"
});
static_assert(kAnswers.size() == kAcross * kDown);

}  // namespace

scene::Scene known_scene() {
  scene::Scene scene;
  scene.name = "self-test";
  scene.materials = {scene::Material{.ambient = vec3(0.1f), .diffuse = vec3(0.8f)}};
  scene.vertices = {{-3, -2, -2}, {3, -2, -1}, {3, 2, -1.5}, {-3, 2, -2.5}};
  scene.triangles = {scene::Triangle{.vertex = {0, 1, 2}, .material = 0, .number = 0},
                     scene::Triangle{.vertex = {0, 2, 3}, .material = 0, .number = 1}};
  scene.spheres = {scene::Sphere{.center = {-1.1, 0.2, 0.3}, .radius = 0.9, .material = 0, .number = 2}};
  scene.cones = {scene::Cone{.base = {1.2, -1, 0.2},
                             .apex = {1.4, 1.1, 0},
                             .base_radius = 0.8,
                             .apex_radius = 0.1,
                             .material = 0,
                             .number = 3}};
  scene.lights = {scene::Light{.position = {0, 3, 6}}};
  scene.camera = scene::Camera{};
  return scene;
}

// The rays go from one eye through the points of a grid, past the scene's edges; none goes along an axis.
std::vector<Ray> known_rays() {
  std::vector<Ray> rays;
  for (int y = 0; y < kDown; ++y)
    for (int x = 0; x < kAcross; ++x)
      rays.push_back({{0.1f, 0.2f, 6},
                      0,
                      {0.12f * static_cast<float>(x) - 0.43f, 0.12f * static_cast<float>(y) - 0.31f, -1},
                      std::numeric_limits<float>::infinity()});
  return rays;
}

std::span<const Answer> known_answers() {
  return kAnswers;
}

}  // namespace kdray::selftest
