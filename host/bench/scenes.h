// What    The scenes of a bench: files, or built in by name. "boxes", an interior (a room with columns and
//         heaps of small boxes, 307,572 triangles); "spheres", displaced spheres on uneven ground (897,500
//         triangles); "displaced", a displaced sphere of a million; "lamps", the room of "boxes" with four
//         lamps that fade, a polished shell and columns of mirror; and the generators' scenes (balls, rings,
//         ...) at their usual sizes.
// Errors  As scene::load's, for files; a name that is neither is told with the names there are.
#pragma once

#include <string>

#include "scene/scene.h"

namespace kdray::bench {

scene::Scene boxes();
scene::Scene spheres();
scene::Scene lamps();

// Throws for a name that is neither, so that a bench of many scenes needn't come to it first.
void require_scene(const std::string& name_or_file);

// "balls" of ".../balls.nff.gz".
std::string short_name(const std::string& name_or_file);

// A built-in scene of that name, or else the file.
scene::Scene load_scene(const std::string& name_or_file);

}  // namespace kdray::bench
