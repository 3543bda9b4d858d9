// What    Closed meshes on a grid of whole numbers, full of T-junctions that triangles without area close: as
//         CAD models and rounded scans have them.
// Shape   A closed mesh whose corners are multiples of `step`, so that its edges pass through points of the
//         grid between their ends. divide() then takes an edge of one face at such a point m, and not of the
//         face on its other side: (x, y, z) becomes (x, m, z) and (m, y, z), and the triangle without area
//         (x, y, m) closes the mesh by index. Faces without area are divided too, so that they hang on each
//         other in chains and fans.
//         Every edge is run through as often one way as the other. All whole numbers are below 2^23 in size,
//         so that floats hold them, also when they are moved by whole numbers and back.
// Why     For all that asks whether a mesh is closed to every ray: leaks, and counts of crossings.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/vec.h"
#include "scene/model/scene.h"

namespace kdray::test {

struct LatticeMesh {
  std::string name;
  std::vector<std::array<std::int64_t, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside

  bool has_area(std::size_t triangle) const;
  std::size_t n_without_area() const;
};

// Twelve faces: all edges along or between the axes.
LatticeMesh lattice_box(std::int64_t step);

// A ball of `rows` rows whose radius changes from corner to corner by up to 3: star-shaped about the origin,
// with corners at multiples of `step` of at most `radius` times it.
LatticeMesh lattice_ball(int rows, std::int64_t radius, std::int64_t step, unsigned seed);

// Divides edges `n` times, or as often as it finds some in 20 times as many attempts.
void divide_edges(LatticeMesh& mesh, std::size_t n, unsigned seed);

// Of the above, some sorts: small and large numbers, few and many divided edges.
std::vector<LatticeMesh> zero_area_meshes();

// In the world at scale * vertex + offset, in one white material.
scene::Scene scene_of(const LatticeMesh& mesh, double scale = 1, const dvec3& offset = dvec3(0));

}  // namespace kdray::test
