// What    teapot: Newell's teapot, each patch cut into size x size quads of two triangles with normals, on a
//         checkerboard of as many squares.
// Shape   Size n: 64n^2 - 8n patch triangles (those that shrink to nothing at the poles are left out), n^2
//         polygons, 2 lights.
// Source  Haines 1987, section "teapot". M. Newell, "The utilization of procedure models in digital image
//         synthesis", 1975, with F. Crow's bottom (IEEE CG&A 7(1), 1987); here by its symmetries: profiles
//         turned in four quarters, tubes mirrored in y.
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "base/vec.h"
#include "scene/generate/nff_writer.h"

namespace kdray::generate {

// ---- The surface: 32 bicubic Bezier patches. Rows of patch[row][column] run along the profile (or the
// tube), columns around it.

namespace {

using BezierPatch = std::array<std::array<dvec3, 4>, 4>;

// A control point of a profile: its radius, the tangent handle of the quarter arc there, its height.
struct ProfilePoint {
  double radius, handle, z;
};

constexpr ProfilePoint round(double radius, double z) {
  return {radius, 0.56 * radius, z};
}

constexpr std::array kRim{round(1.4, 2.4), round(1.3375, 2.53125), round(1.4375, 2.53125), round(1.5, 2.4)};
constexpr std::array kBody{round(1.5, 2.4), round(1.75, 1.875), round(2, 1.35),  round(2, 0.9),
                           round(2, 0.45),  round(1.5, 0.225),  round(1.5, 0.15)};
constexpr std::array kLid{round(0, 3.15),   ProfilePoint{0.8, 0.45, 3.15},
                          round(0, 2.85),   round(0.2, 2.7),
                          round(0.4, 2.55), round(1.3, 2.55),
                          round(1.3, 2.4)};
constexpr std::array kBottom{round(0, 0), round(1.425, 0), round(1.5, 0.075), round(1.5, 0.15)};

// A cross section of a tube that is mirrored in y = 0: from (x0, z0) around, at y = -half, to (x1, z1).
struct Section {
  double x0, z0, x1, z1, half;
};

constexpr std::array kHandle{Section{-1.6, 2.025, -1.5, 2.25, 0.3}, Section{-2.3, 2.025, -2.5, 2.25, 0.3},
                             Section{-2.7, 2.025, -3, 2.25, 0.3},   Section{-2.7, 1.8, -3, 1.8, 0.3},
                             Section{-2.7, 1.575, -3, 1.35, 0.3},   Section{-2.5, 1.125, -2.65, 0.9375, 0.3},
                             Section{-2, 0.9, -1.9, 0.6, 0.3}};
constexpr std::array kSpout{
    Section{1.7, 1.425, 1.7, 0.6, 0.66},       Section{2.6, 1.425, 3.1, 0.825, 0.66},
    Section{2.3, 2.1, 2.4, 2.025, 0.25},       Section{2.7, 2.4, 3.3, 2.4, 0.25},
    Section{2.8, 2.475, 3.525, 2.49375, 0.25}, Section{2.9, 2.475, 3.45, 2.5125, 0.15},
    Section{2.8, 2.4, 3.2, 2.4, 0.15}};

enum class Sense { clockwise, counter_clockwise };  // seen from above

// Quarter turns are exact: without rounding, neighbouring patches meet in the same numbers.
dvec3 quarter_turns(dvec3 p, int turns, Sense sense) {
  for (int i = 0; i < turns; ++i)
    p = sense == Sense::clockwise ? dvec3(p.y, -p.x, p.z) : dvec3(-p.y, p.x, p.z);
  return p;
}

std::array<dvec3, 4> quarter_arc(const ProfilePoint& p, Sense sense) {
  const double side = sense == Sense::clockwise ? -1 : 1;
  return {dvec3{p.radius, 0, p.z},
          {p.radius, side * p.handle, p.z},
          {p.handle, side * p.radius, p.z},
          {0, side * p.radius, p.z}};
}

// Adds a ring of four patches for every three points along the profile; neighbours share a row.
void add_round(std::vector<BezierPatch>& patches, std::span<const ProfilePoint> profile, Sense sense) {
  for (std::size_t first = 0; first + 3 < profile.size(); first += 3)
    for (int quarter = 0; quarter < 4; ++quarter) {
      BezierPatch& patch = patches.emplace_back();
      for (std::size_t row = 0; row < 4; ++row) {
        patch[row] = quarter_arc(profile[first + row], sense);
        for (dvec3& p : patch[row]) p = quarter_turns(p, quarter, sense);
      }
    }
}

void add_tube(std::vector<BezierPatch>& patches, std::span<const Section> sections) {
  for (std::size_t first = 0; first + 3 < sections.size(); first += 3) {
    BezierPatch near, far;
    for (std::size_t row = 0; row < 4; ++row) {
      const Section& s = sections[first + row];
      near[row] = {dvec3{s.x0, 0, s.z0}, {s.x0, -s.half, s.z0}, {s.x1, -s.half, s.z1}, {s.x1, 0, s.z1}};
      far[row] = {dvec3{s.x1, 0, s.z1}, {s.x1, s.half, s.z1}, {s.x0, s.half, s.z0}, {s.x0, 0, s.z0}};
    }
    patches.push_back(near);
    patches.push_back(far);
  }
}

std::vector<BezierPatch> teapot_patches() {
  std::vector<BezierPatch> patches;
  patches.reserve(32);
  add_round(patches, kRim, Sense::clockwise);
  add_round(patches, kBody, Sense::clockwise);
  add_tube(patches, kHandle);
  add_tube(patches, kSpout);
  add_round(patches, kLid, Sense::clockwise);
  add_round(patches, kBottom, Sense::counter_clockwise);
  return patches;
}

}  // namespace

// ---- The scene

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
