// What    tetra: Sierpinski's tetrahedron.
// Shape   Size n: 4^n triangles, 1 light.
// Source  Haines 1987, section "tetra"; the scene of A. Glassner, IEEE CG&A 4(10), 1984, and of Kay and
//         Kajiya, 1986.
#include <array>

#include "scene/generate/nff_writer.h"
#include "scene/generate/scenes.h"

namespace kdray::generate {

namespace {

// Four corners of a cube, no two of them joined by an edge of it.
constexpr std::array<dvec3, 4> kCorners{dvec3{-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}, {1, 1, 1}};

void write_tetrahedron(NffWriter& nff, const dvec3& center, double half) {
  constexpr int faces[4][3] = {{0, 1, 2}, {3, 2, 1}, {2, 3, 0}, {1, 0, 3}};
  for (const auto& f : faces)
    nff.polygon(
        {center + half * kCorners[f[0]], center + half * kCorners[f[1]], center + half * kCorners[f[2]]});
}

void write_levels(NffWriter& nff, int levels, const dvec3& center, double half) {
  if (levels == 1) return write_tetrahedron(nff, center, half);
  for (const dvec3& corner : kCorners) write_levels(nff, levels - 1, center + half / 2 * corner, half / 2);
}

}  // namespace

void write_tetra(std::ostream& out, int size) {
  NffWriter nff(out);
  nff.background(kSkyBlue);
  nff.view({.from = {1.02285, -3.17715, -2.17451},
            .at = {-0.004103, -0.004103, 0.216539},
            .up = {-0.816497, -0.816497, 0.816497},
            .angle = 45,
            .hither = 1});
  nff.light({2, -18, -5});
  nff.surface({.color = {1, 0.2, 0.2}, .diffuse = 1, .specular = 0});
  write_levels(nff, size, {0, 0, 0}, 1);
}

}  // namespace kdray::generate
