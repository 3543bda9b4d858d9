// What    Another view of a scene than the one that its file has, or that frame_scene() gave it.
// Shape   What isn't asked for stays as it is. Where the camera was made up, it is made up again about what
//         was asked for, so that all is in the picture; lights that were made up for it follow it.
// Units   World units, angles in radians.
// Errors  kdray::Error, ErrorCode::usage: a camera that the file doesn't have, directions that make no view.
#pragma once

#include <optional>

#include "scene/model/scene.h"

namespace kdray::scene {

struct View {
  std::optional<int> camera = {};  // of Scene::cameras
  std::optional<dvec3> from = {}, at = {}, up = {};
  std::optional<double> vertical_fov = {};
  std::optional<double> ortho_width = {};  // parallel eye rays; 0: as wide as the scene needs
  std::optional<double> aperture = {}, focus = {};
  double headlight = 0;  // above 0: one more light, of this strength, at the camera
};

// The camera that it asks for. `aspect`: width by height of the picture that is going to be made.
Camera camera_of(const Scene& scene, const View& view, double aspect);

// Puts it into the scene, with lights for it where they were made up, and the headlight.
void set_view(Scene& scene, const View& view, double aspect);

}  // namespace kdray::scene
