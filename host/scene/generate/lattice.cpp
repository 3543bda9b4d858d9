// What    lattice: mirroring spheres at the points of a cubic lattice, joined by matte cylinders; the eye is
//         inside.
// Shape   Size n: (n+1)^3 spheres, 3n(n+1)^2 cones, 6 lights.
// Source  The SPD package (A. Costa).
#include <array>
#include <cmath>

#include "scene/generate/nff_writer.h"
#include "scene/generate/scenes.h"

namespace kdray::generate {

namespace {

constexpr double kBallRadius = 1.0 / 4, kRodRadius = 1.0 / 16;  // radii, in cells

void write_view_and_lights(NffWriter& nff, int size) {
  // The camera looks down a corridor from the middle of a cell.
  const double x = (size / 2 + 0.5) / size, back = 1 / (2.0 * size);
  nff.view({.from = {x, 1, 1 - back}, .at = {x, -1, -1 - back}, .up = {0.2, 1, 0}, .angle = 60, .hither = 0});
  for (int axis = 0; axis < 3; ++axis)
    for (const double place : {2.0, -1.0}) {
      dvec3 light(0.5);
      light[axis] = place;
      nff.light(light);
    }
}

// The rods from the point towards +x, +y and +z, as far as there is a next point.
void write_rods(NffWriter& nff, const std::array<int, 3>& at, int size) {
  const double cell = 1.0 / size;
  // Rods start about half a ball's radius from its centre: their rims are hidden inside.
  const double sunk = kBallRadius * cell * (1 - std::sqrt(kRodRadius / kBallRadius)) * 0.99;
  const dvec3 point = dvec3(at[0], at[1], at[2]) / double(size);
  for (int axis = 0; axis < 3; ++axis) {
    if (at[axis] == size) continue;
    dvec3 color(0.1), base = point, apex = point;
    color[axis] = 0.9;
    base[axis] += sunk;
    apex[axis] += cell - sunk;
    nff.surface({.color = color, .diffuse = 0.99, .specular = 0});
    nff.cone(base, kRodRadius * cell, apex, kRodRadius * cell);
  }
}

}  // namespace

void write_lattice(std::ostream& out, int size) {
  NffWriter nff(out);
  nff.background(kSkyBlue);
  write_view_and_lights(nff, size);
  for (int x = 0; x <= size; ++x)
    for (int y = 0; y <= size; ++y)
      for (int z = 0; z <= size; ++z) {
        nff.surface({.color = {0.9, 0.9, 0.9}, .diffuse = 0.5, .specular = 0.5, .shine = 3.0827});
        nff.sphere(dvec3(x, y, z) / double(size), kBallRadius / size);
        write_rods(nff, {x, y, z}, size);
      }
}

}  // namespace kdray::generate
