// What    Makes the normals an importer read fit scene.h: all of unit length. A triangle that uses one
//         without a direction is shaded flat, and the scene says so.
// Shape   Called once, after the last triangle. Normals nobody asked for are dropped.
#pragma once

#include <string>

#include "scene/scene.h"

namespace kdray::scene {

// Returns how many triangles are shaded flat.
std::size_t settle_normals(Scene& scene, const std::string& file);

// What the scene says of so many.
std::string flat_warning(const std::string& file, std::size_t n_flat);

// The unit vector along `v`, whatever its length; zero when it has no direction.
vec3 direction_of(const dvec3& v);

}  // namespace kdray::scene
