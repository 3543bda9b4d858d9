// What    Gives a scene without camera or lights a three-quarter view of its bounding box and two lights
//         (docs/cli.md), and leaves alone what the file said. Where a few primitives reach far beyond
//         the others (a ground plane), the others are framed.
#pragma once

#include "scene/scene.h"

namespace kdray::scene {

void frame_scene(Scene& scene);

}  // namespace kdray::scene
