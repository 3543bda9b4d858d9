// What    A studio for a scene that has neither camera nor lights: a camera in front of it, to the right and
//         a little above, that it just fits; a key, a fill and a rim light that follow the camera and throw
//         soft shadows; a backdrop; and a floor that it stands on. In a room, the camera and two lamps are in
//         it.
// Shape   Scene::framing.studio says what is known of the scene. What a View asks for wins.
// Units   World units, angles in radians.
#pragma once

#include "scene/model/frame.h"

namespace kdray::scene {

// Sets what the studio decides of a camera, as far as the view leaves it open. (The view's own values are put
// into the camera afterwards.)
void set_studio_camera(Camera& camera, const Framing& framing, const View& view, double aspect);

// Adds lights, a backdrop where the scene has none of its own, and the floor, for the camera.
void furnish_studio(Scene& scene, const View& view);

}  // namespace kdray::scene
