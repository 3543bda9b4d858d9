// What    Scenes of one object many times over, in a lattice, a pyramid or a spiral: lattice, rings and
//         shells.
#include <array>
#include <cmath>
#include <numbers>

#include "scene/generate/nff_writer.h"
#include "scene/generate/rotation.h"

namespace kdray::generate {

// ---- lattice: mirroring spheres at the points of a cubic lattice, joined by matte cylinders; the eye is
// inside.
// Size n: (n+1)^3 spheres, 3n(n+1)^2 cones, 6 lights.
// The SPD package (A. Costa).

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

// ---- rings: six interlocked pentagonal rings through the edge midpoints of a dodecahedron, such objects
// stacked to a pyramid that is seen from its tip, and a wall behind it.
// Size n: 1 + 4 + ... + n^2 objects of 30 cones and 30 spheres, that is 5n(n+1)(2n+1) of each; 1
// polygon, 3 lights.
// Haines 1987, section "rings".

namespace {

using std::numbers::pi;
constexpr double kRadius = 0.07412;  // of rods and joints, as published

using Ring = std::array<dvec3, 5>;
using Object = std::array<Ring, 6>;

// One pentagon lies in the xy plane, the five others are tilted by the angle between two faces of a
// dodecahedron.
Object ring_vertices() {
  const double scale = 1 / (1 + kRadius);  // fits a sphere of radius 1
  Object object;
  for (int i = 0; i < 5; ++i)
    object[0][i] = scale * dvec3(std::cos(i * 2 * pi / 5), std::sin(i * 2 * pi / 5), 0);
  const dmat3 tilt = rotation_x(2 * std::acos(std::cos(pi / 3) / std::sin(pi / 5)));
  for (int k = 1; k < 6; ++k) {
    const dmat3 place = rotation_z(pi * (2 * k - 1) / 5) * tilt;
    for (int i = 0; i < 5; ++i) object[k][i] = place * object[0][i];
  }
  return object;
}

void write_object(NffWriter& nff, const Object& object, const dvec3& offset) {
  static constexpr std::array<dvec3, 6> colors{dvec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1},
                                               {0, 1, 1},      {1, 0, 1}, {1, 1, 0}};
  for (std::size_t k = 0; k < object.size(); ++k) {
    nff.surface({.color = colors[k], .diffuse = 0.5, .specular = 0.2, .shine = 3.0827});
    for (int i = 0; i < 5; ++i) {
      const dvec3 joint = object[k][i] + offset, previous = object[k][(i + 4) % 5] + offset;
      nff.cone(joint, kRadius, previous, kRadius);
      nff.sphere(joint, kRadius);
    }
  }
}

// The wall just fills the view of 45 degrees.
void write_wall(NffWriter& nff, const dvec3& eye, double y) {
  const double half = 1.01 * (y - eye.y) * std::tan(pi / 8);
  nff.surface({.color = {1, 1, 1}, .diffuse = 1, .specular = 0});
  nff.polygon({{eye.x + half, y, eye.z + half},
               {eye.x - half, y, eye.z + half},
               {eye.x - half, y, eye.z - half},
               {eye.x + half, y, eye.z - half}});
}

}  // namespace

void write_rings(std::ostream& out, int size) {
  NffWriter nff(out);
  const double layer = 1 / std::sin(pi / 8);  // between the layers of the pyramid
  const dvec3 eye{-1, -layer, 0.5};
  nff.background(kSkyBlue);
  nff.view({.from = eye, .at = eye + dvec3(0, 1, 0), .up = {0, 0, 1}, .angle = 45, .hither = 1});
  nff.light({3, -layer, 3});
  nff.light({-4, -layer, 1});
  nff.light({2, -layer, -4});
  write_wall(nff, eye, layer * (size + 1));
  const Object object = ring_vertices();
  for (int depth = 0; depth < size; ++depth)
    for (int z = 0; z <= depth; ++z)
      for (int x = 0; x <= depth; ++x)
        write_object(nff, object, {2 * x - depth, layer * (depth + 1), 2 * z - depth});
}

// ---- shells: a seashell of spheres along a growing spiral; most of them overlap, which is hard on any
// tree.
// Size n: 180*2^n + 1 spheres, 1 light.
// C. Pickover, IEEE CG&A 9(6), 1989, as in the SPD package.

void write_shells(std::ostream& out, int size) {
  constexpr double growth = 0.15;  // of the radius, per radian, in the exponent
  constexpr double drop = -2;      // height in radii
  constexpr double turns = 9;

  NffWriter nff(out);
  nff.background(kSkyBlue);
  nff.view({.from = {-6, -60, 35}, .at = {0, 8, -15}, .up = {0, 0, 1}, .angle = 45, .hither = 0.5});
  nff.light({-100, -100, 100});
  nff.surface({.color = {1, 0.8, 0.4}, .diffuse = 0.8, .specular = 0.2, .shine = 45.2776, .index = 1});
  // Two thirds of the turns wind inward of radius 1, where the spheres become tiny.
  const int steps = 180 << size;
  for (int i = -2 * (steps / 3); i <= steps / 3; ++i) {
    const double angle = turns * 2 * std::numbers::pi * i / steps;
    const double radius = std::exp(growth * angle);
    nff.sphere(radius * dvec3(std::sin(angle), std::cos(angle), drop), radius);
  }
}

}  // namespace kdray::generate
