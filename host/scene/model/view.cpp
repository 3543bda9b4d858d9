#include "scene/model/view.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "base/local_space.h"
#include "scene/model/check_scene.h"
#include "scene/model/frame.h"

namespace kdray::scene {

namespace {

const Camera& numbered_camera(const Scene& scene, int number) {
  const std::size_t n = scene.cameras.size();
  if (number >= 0 && static_cast<std::size_t>(number) < n)
    return scene.cameras[static_cast<std::size_t>(number)];
  const std::string there = n == 0   ? "has no camera"
                            : n == 1 ? "has one camera, number 0"
                                     : "has cameras 0 to " + std::to_string(n - 1);
  throw Error(ErrorCode::usage,
              "there is no camera " + std::to_string(number) + ": " + scene.name + " " + there);
}

// The width that shows all; any width does where there is nothing.
double width_of(const DBox& box, const Camera& camera, double aspect) {
  const double width = width_to_show(box, camera, aspect);
  return width > 0 ? width : 1;
}

// Where rays are parallel, so is its light.
Light headlight(const Camera& camera, double strength) {
  Light light;
  light.kind = camera.ortho_width > 0 ? LightKind::directional : LightKind::point;
  light.position = camera.from;
  light.direction = safe_normalize(camera.at - camera.from);
  light.color = vec3(static_cast<float>(strength));
  return light;
}

void check(const Camera& camera) {
  if (const char* const fault = fault_of(camera))
    throw Error(ErrorCode::usage, std::string("the view: ") + fault + "; give other --from, --at or --up");
}

}  // namespace

Camera camera_of(const Scene& scene, const View& view, double aspect) {
  Camera camera = view.camera ? numbered_camera(scene, *view.camera) : scene.camera.value_or(Camera{});
  const bool made_up = scene.framing.camera && !view.camera;
  if (view.from) camera.from = *view.from;
  if (view.at) camera.at = *view.at;
  if (view.up) camera.up = *view.up;
  if (view.vertical_fov) camera.vertical_fov = *view.vertical_fov, camera.ortho_width = 0;
  if (made_up && !view.from)
    camera = three_quarter_view(scene.framing.box, camera, std::min(aspect, aspect_of(scene.settings)));
  check(camera);
  if (view.ortho_width && *view.ortho_width > 0)
    camera.ortho_width = *view.ortho_width;
  else if (view.ortho_width)
    camera.ortho_width = width_of(scene.framing.box, camera, aspect);
  if (view.aperture) camera.aperture = *view.aperture;
  if (view.focus) camera.focus = *view.focus;
  return camera;
}

void set_view(Scene& scene, const View& view, double aspect) {
  scene.camera = camera_of(scene, view, aspect);
  if (scene.framing.lights) {
    scene.lights.clear();
    add_lights(scene);
  }
  if (view.headlight > 0) scene.lights.push_back(headlight(*scene.camera, view.headlight));
}

}  // namespace kdray::scene
