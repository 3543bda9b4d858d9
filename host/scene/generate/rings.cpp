// What    rings: six interlocked pentagonal rings through the edge midpoints of a dodecahedron, such objects
//         stacked to a pyramid that is seen from its tip, and a wall behind it.
// Shape   Size n: 1 + 4 + ... + n^2 objects of 30 cones and 30 spheres, that is 5n(n+1)(2n+1) of each; 1
//         polygon, 3 lights.
// Source  Haines 1987, section "rings".
#include <array>
#include <cmath>
#include <numbers>

#include "scene/generate/nff_writer.h"
#include "scene/generate/rotation.h"
#include "scene/generate/scenes.h"

namespace kdray::generate {

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

}  // namespace kdray::generate
