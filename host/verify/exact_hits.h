// What    What one primitive does to one ray, in double and with the error known: only what is certain is
//         told.
// Shape   Everything about the scene's centre, on the primitives as rays see them.
#pragma once

#include <optional>

#include "kdray/kdray.h"
#include "scene/geometry.h"
#include "verify/mesh.h"

namespace kdray::verify {

struct Line {
  dvec3 origin, direction;
};
inline Line line_of(const Ray& ray) {
  return {{ray.origin[0], ray.origin[1], ray.origin[2]},
          {ray.direction[0], ray.direction[1], ray.direction[2]}};
}

// t where the line surely meets the triangle or sphere: it passes its outline by more than `margin`, a
// length, on the inner side.
std::optional<double> sure_hit(const Line& line, const dvec3& a, const dvec3& b, const dvec3& c,
                               double margin);
std::optional<double> sure_hit(const Line& line, const scene::SphereGeometry& sphere, double margin);

// +1 or -1: the origin surely has the plane of the triangle before or behind itself; 0: it may lie in it.
int side_of_plane(const Line& line, const dvec3& a, const dvec3& b, const dvec3& c);

// Along a line a solid's surface is where a*t^2 + 2*b*t + c = 0; inside it is negative. A cone's is that of
// the whole double cone.
struct Quadratic {
  double a, b, c;
};
Quadratic along(const Line& line, const scene::SphereGeometry& sphere);
Quadratic along(const Line& line, const scene::ConeGeometry& cone);

// Outwards at a place on the surface, of any length.
dvec3 outward(const dvec3& point, const scene::SphereGeometry& sphere);
dvec3 outward(const dvec3& point, const scene::ConeGeometry& cone);

// Whether a hit at t is surely none of a ray that has just left the surface, to the outside or to the inside:
// it began on the other side, or goes away from the solid, or is still on its way through the inside. (Where
// a <= 0, along a cone, nothing is sure.)
bool hits_again(const Quadratic& q, double t, bool outside);

}  // namespace kdray::verify
