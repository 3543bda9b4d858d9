// What    shells: a seashell of spheres along a growing spiral; most of them overlap, which is hard on any
//         tree.
// Shape   Size n: 180*2^n + 1 spheres, 1 light.
// Source  C. Pickover, IEEE CG&A 9(6), 1989, as in the SPD package.
#include <cmath>
#include <numbers>

#include "scene/generate/nff_writer.h"
#include "scene/generate/scenes.h"

namespace kdray::generate {

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
