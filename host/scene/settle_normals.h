// What    Makes the normals an importer read fit scene.h: all of unit length. A triangle that uses one
//         without a direction is shaded flat, and the scene says so.
// Shape   Called once, after the last triangle. Normals nobody asked for are dropped.
#pragma once

#include <string>

#include "scene/scene.h"

namespace kdray::scene {

void settle_normals(Scene& scene, const std::string& file);

// The unit vector along `v`, whatever its length; zero when it has no direction.
vec3 direction_of(const dvec3& v);

}  // namespace kdray::scene
