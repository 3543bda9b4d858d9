// What    Normals at triangles' corners: those that an importer read made to fit scene.h, and smooth ones
//         where a file has none.
// Source  Thuermer and Wuethrich, "Computing vertex normals from polygonal facets", JGT 1998, for the weights
//         of smooth_normals().
#pragma once

#include <functional>
#include <string>

#include "scene/model/scene.h"

namespace kdray::scene {

// settle_normals() and settle_vertices() are called once, after the last triangle: then normals all have unit
// length and vertices are finite. A triangle that uses a normal without a direction is shaded flat, one that
// uses a vertex which is not finite is left out, and the scene says so. Normals without a direction become
// (0, 0, 1). A triangle that is left out keeps its number, and three times the same vertex (geometry.h leaves
// out what has no area).

// Returns how many triangles are shaded flat.
std::size_t settle_normals(Scene& scene, const std::string& file);

// `place_of` returns where vertex i stands in the file, for the warning about the first one that is not
// finite.
void settle_vertices(Scene& scene, const std::function<std::string(std::size_t)>& place_of);

// Returns the warning about so many triangles.
std::string flat_warning(const std::string& file, std::size_t n_flat);

// Returns the unit vector along `v`, whatever its length; zero when it has no direction.
vec3 direction_of(const dvec3& v);

// Gives normals to the triangles that have none, from the faces around each corner: the sum of their normals,
// weighted by their angles there, over those that turn by no more than `degrees` against the corner's own
// face. An edge that is sharper than that stays sharp. A triangle without area has no face to be sharp
// against: it takes them all. Corners at the same place count as one, whichever vertices the file gives them.
// It takes as many steps as there are pairs of faces around a place. A place of over 1000 faces (the tip of a
// fan) keeps its faces' own normals.
void smooth_normals(Scene& scene, double degrees);

}  // namespace kdray::scene
