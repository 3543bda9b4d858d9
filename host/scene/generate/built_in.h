// What    Scenes to measure and to tune on: files, or by name those that are built in. These are "boxes",
//         an interior (a room with columns and heaps of small boxes, 307,572 triangles); "spheres",
//         displaced spheres on uneven ground (897,800 triangles); "displaced", a displaced sphere of a
//         million; "lamps", the room of "boxes" with four lamps that fade, a polished shell and columns of
//         mirror; and the generators' scenes (balls, rings, ...) at their usual sizes.
// Errors  Those of scene::load for files; for a name that is neither, kdray::Error with the names there
//         are.
#pragma once

#include <string>

#include "scene/model/scene.h"

namespace kdray::generate {

scene::Scene boxes();
scene::Scene spheres();
scene::Scene lamps();

// Throws for a name that is neither, so that a run over many scenes can refuse it before the first of them.
void require_scene(const std::string& name_or_file);

// Returns the built-in scene of that name, or else that of the file.
scene::Scene load_scene(const std::string& name_or_file);

}  // namespace kdray::generate
