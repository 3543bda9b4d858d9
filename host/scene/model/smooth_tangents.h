// What    Tangents of triangles that have normals and texture coordinates at their corners, as glTF wants
//         them where a file brings none: smooth across triangles whose corners agree in place, normal,
//         coordinates and handedness.
// Shape   A corner's tangent is the mean of the triangles' own around it, each laid into the plane at the
//         normal, made a unit vector and weighted by the angle there.
// Errors  Triangles without area, in space or in the picture, get none, and neither does one whose corner has
//         none.
// Source  M. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, and MikkTSpace, which differs in
//         two cases: it keeps fans apart that touch at a corner alone, and lends tangents to triangles
//         without any.
#pragma once

#include <cstddef>

#include "scene/model/scene.h"

namespace kdray::scene {

// Of the triangles from `first` on, into texturing.tangents; `set` is that of the coordinates.
void smooth_tangents(Scene& scene, std::size_t first, std::size_t set);

}  // namespace kdray::scene
