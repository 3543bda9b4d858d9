// What    Tangents at triangles' corners: how they are kept, in a set of coordinates of their own
//         (texturing.h), and smooth ones where a file has none.
// Shape   A tangent is kept as two numbers: its direction on an octahedron, laid flat into the square from -1
//         to 1, the second number moved off 0 by KDRAY_TANGENT_OFFSET, to the side of handedness: which way
//         round the picture lies. So 0, 0 is no tangent.
// Source  Meyer, Suessmuth, Sussner, Stamminger, Greiner, "On floating-point normal vectors", EGSR 2010. M.
//         Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, and MikkTSpace, which differs in two
//         cases: it keeps fans apart that touch at a corner alone, and lends tangents to triangles without
//         any.
#pragma once

#include <array>
#include <cstddef>

#include "base/vec.h"
#include "scene/model/scene.h"
#include "scene/textures/texturing.h"

namespace kdray::scene {

// `hand`: 1 where the picture lies the right way round (up, in it, is normal x tangent), -1 where mirrored.
struct Tangent {
  dvec3 direction{0};
  double hand = 1;
};

// Return a tangent as it is kept, and back. A direction of no length, or that is not finite, is no tangent.
std::array<float, 2> packed_tangent(const Tangent& tangent);
Tangent unpacked_tangent(const float* packed);  // no tangent: direction 0

// Moves tangents as `linear` moves edges.
void move_tangents(const dmat3& linear, PageVector<layout::TexCoords>& tangents);

// Makes the tangents of the triangles from `first` on, which have normals and texture coordinates, in
// texturing.tangents; `set` is the number of the coordinates. As glTF wants it, they are smooth across
// triangles whose corners agree in place, normal, coordinates and handedness: a corner's tangent is the mean
// of the triangles' own around it, each laid into the plane at the normal, made a unit vector and weighted by
// the angle there. Triangles without area, in space or in the picture, get none, and neither does one whose
// corner has none.
void smooth_tangents(Scene& scene, std::size_t first, std::size_t set);

}  // namespace kdray::scene
