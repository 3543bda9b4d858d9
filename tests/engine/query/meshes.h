// What    Closed meshes for queries: every edge belongs to an even number of triangles. Beside those of
//         stress/meshes.h, which have two at each edge.
#pragma once

#include <cstdint>
#include <vector>

#include "stress/meshes.h"

namespace kdray::test {

using stress::NamedMesh;

scene::Scene mesh_of(const std::vector<dvec3>& vertices,
                     const std::vector<std::array<std::uint32_t, 3>>& triangles);

scene::Scene torus(int around, int across);
scene::Scene icosphere(int splits);  // each triangle in four, so often
// The outside of cubes of a grid, chosen at random: whole numbers for coordinates, faces in common planes,
// edges of four faces.
scene::Scene cubes(std::uint64_t seed, int side);
// Strips of slivers a ten-thousandth as wide as long, closed to a flat box.
scene::Scene slivers(int n);
// Two tetrahedra that share a vertex; a box within a box; a tetrahedron twice.
scene::Scene touching();
scene::Scene nested();
scene::Scene doubled();

// Edges are those between the same two points.
bool edges_are_even(const scene::Scene& scene);
std::vector<NamedMesh> closed_meshes();

}  // namespace kdray::test
