// What    Makes the normals and vertices an importer read fit scene.h: normals all of unit length, vertices
//         finite. A triangle that uses a normal without a direction is shaded flat, one that uses a vertex
//         which is not finite is left out, and the scene says so.
// Shape   Called once, after the last triangle. Normals nobody asked for are dropped. A triangle that is left
//         out keeps its number, and three times the same vertex (geometry.h leaves out what has no area).
#pragma once

#include <functional>
#include <string>

#include "scene/model/scene.h"

namespace kdray::scene {

// Returns how many triangles are shaded flat.
std::size_t settle_normals(Scene& scene, const std::string& file);

// `place_of` names where vertex i stands, for the warning: of the first one that is not finite.
void settle_vertices(Scene& scene, const std::function<std::string(std::size_t)>& place_of);

// What the scene says of so many.
std::string flat_warning(const std::string& file, std::size_t n_flat);

// The unit vector along `v`, whatever its length; zero when it has no direction.
vec3 direction_of(const dvec3& v);

}  // namespace kdray::scene
