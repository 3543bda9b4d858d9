#include "scene/generate/built_in.h"

namespace kdray::generate {

// The room of `boxes` in the evening: four lamps that fade with the distance, a polished shell, columns that
// are mirrors. What depth, least weight and the lights' reach leave out can all be seen.
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

}  // namespace kdray::generate
