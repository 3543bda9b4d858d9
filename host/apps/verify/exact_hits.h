// What    What one primitive does to one ray, in double and with the error known: only what is certain is
//         told. Triangles' part is here, the shapes' in primitives/<kind>_exact.cpp.
// Shape   Everything about the scene's centre, on the primitives as rays see them.
#pragma once

#include <optional>

#include "apps/verify/mesh.h"
#include "kdray/kdray.h"
#include "scene/model/geometry.h"
#include "scene/primitives/shapes.h"

namespace kdray::verify {

using primitives::Line;
inline Line line_of(const Ray& ray) {
  return {{ray.origin[0], ray.origin[1], ray.origin[2]},
          {ray.direction[0], ray.direction[1], ray.direction[2]}};
}

// t where the line surely meets the triangle: it passes its outline by more than `margin`, a length, on the
// inner side.
std::optional<double> sure_hit(const Line& line, const dvec3& a, const dvec3& b, const dvec3& c,
                               double margin);

// +1 or -1: the origin surely has the plane of the triangle before or behind itself; 0: it may lie in it.
int side_of_plane(const Line& line, const dvec3& a, const dvec3& b, const dvec3& c);

}  // namespace kdray::verify
