// What    teapot: Newell's teapot, each patch cut into size x size quads of two triangles with normals, on a
//         checkerboard of as many squares.
// Shape   Size n: 64n^2 - 8n patch triangles (those that shrink to nothing at the poles are left out), n^2
//         polygons, 2 lights.
// Source  Haines 1987, section "teapot"; teapot_patches.h for the surface.
#include <array>
#include <cmath>

#include "scene/generate/nff_writer.h"
#include "scene/generate/scenes.h"
#include "scene/generate/teapot_patches.h"

namespace kdray::generate {

namespace {

struct Basis {
  std::array<double, 4> value, derivative;
};

Basis bernstein(double t) {
  const double u = 1 - t;
  return {{u * u * u, 3 * t * u * u, 3 * t * t * u, t * t * t},
          {-3 * u * u, 3 * u * u - 6 * t * u, 6 * t * u - 3 * t * t, 3 * t * t}};
}

// Where a row of the patch shrinks to a point, at the knob and under the bottom, there is no cross product.
bool at_pole(const dvec3& p) {
  return std::abs(p.x) < 1e-4 && std::abs(p.y) < 1e-4;
}

PatchVertex evaluate(const BezierPatch& patch, double s, double t) {
  const Basis along = bernstein(s), around = bernstein(t);
  dvec3 position(0), ds(0), dt(0);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) {
      const dvec3& p = patch[row][column];
      position += along.value[row] * around.value[column] * p;
      ds += along.derivative[row] * around.value[column] * p;
      dt += along.value[row] * around.derivative[column] * p;
    }
  if (at_pole(position)) return {position, {0, 0, position.z > 1.5 ? 1.0 : -1.0}};
  return {position, glm::normalize(glm::cross(dt, ds))};
}

void write_triangle(NffWriter& nff, const PatchVertex& a, const PatchVertex& b, const PatchVertex& c) {
  const int poles = at_pole(a.position) + at_pole(b.position) + at_pole(c.position);
  if (poles > 1) return;  // both at the same pole: no area
  const std::array<PatchVertex, 3> triangle{a, b, c};
  nff.patch(triangle);
}

void write_patch(NffWriter& nff, const BezierPatch& patch, int size) {
  const auto vertex = [&](int row, int column) {
    return evaluate(patch, row / double(size), column / double(size));
  };
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      const PatchVertex a = vertex(row, column), c = vertex(row + 1, column + 1);
      write_triangle(nff, a, vertex(row, column + 1), c);
      write_triangle(nff, c, vertex(row + 1, column), a);
    }
}

void write_squares(NffWriter& nff, int size, int parity) {
  const auto coordinate = [&](int i) { return 4 * (2.0 * i / size - 1); };
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) {
      if ((i + j) % 2 != parity) continue;
      const double x0 = coordinate(i), x1 = coordinate(i + 1), y0 = coordinate(j), y1 = coordinate(j + 1);
      nff.polygon({{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}});
    }
}

}  // namespace

void write_teapot(std::ostream& out, int size) {
  NffWriter nff(out);
  nff.background(kSkyBlue);
  nff.view({.from = {4.86, 7.2, 5.4}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 45, .hither = 1});
  nff.light({-3.1, 9.8, 12.1});
  nff.light({11.3, 5.1, 8.8});
  nff.surface({.color = {1, 1, 1}, .diffuse = 0.5, .specular = 0.5, .shine = 4.81884});
  write_squares(nff, size, 1);
  nff.surface({.color = {0.5, 0.5, 0.5}, .diffuse = 0.5, .specular = 0.5, .shine = 4.81884});
  write_squares(nff, size, 0);
  nff.surface({.color = {1, 0.5, 0.1}, .diffuse = 0.75, .specular = 0.25, .shine = 3.0827});
  for (const BezierPatch& patch : teapot_patches()) write_patch(nff, patch, size);
}

}  // namespace kdray::generate
