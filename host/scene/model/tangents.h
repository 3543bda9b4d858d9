// What    Tangents at triangles' corners as they are kept, in a set of coordinates of their own
//         (texturing.h): a direction in two numbers, and which way round the picture lies.
// Shape   The direction on an octahedron, laid flat into the square from -1 to 1; the second number is moved
//         off 0 by kdray's KDRAY_TANGENT_OFFSET, to the side of handedness. So 0, 0 is no tangent.
// Source  Meyer, Suessmuth, Sussner, Stamminger, Greiner, "On floating-point normal vectors", EGSR 2010.
#pragma once

#include <array>

#include "base/vec.h"
#include "scene/textures/texturing.h"

namespace kdray::scene {

// `hand`: 1 where the picture lies the right way round (up, in it, is normal x tangent), -1 where mirrored.
struct Tangent {
  dvec3 direction{0};
  double hand = 1;
};

// A direction of no length, or that is not finite, is no tangent.
std::array<float, 2> packed_tangent(const Tangent& tangent);
Tangent unpacked_tangent(const float* packed);  // no tangent: direction 0

// Moves them as `linear` moves edges.
void move_tangents(const dmat3& linear, PageVector<layout::TexCoords>& tangents);

}  // namespace kdray::scene
