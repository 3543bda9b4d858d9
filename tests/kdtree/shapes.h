// What    Geometry for the tests of the tree: random, regular and hostile, all from a seed.
// Shape   Triangles have coordinates of a few bits (multiples of 2^-16 below 2^7), so that points on them are
//         exact.
#pragma once

#include <random>

#include "scene/geometry.h"

namespace kdray::test {

using Random = std::mt19937_64;

float uniform(Random& random, float lo, float hi);
vec3 random_vec3(Random& random, float lo, float hi);  // multiples of 2^-16

void add_triangle(scene::Geometry& g, const vec3& a, const vec3& b, const vec3& c);
void add_triangles(scene::Geometry& g, Random& random, int n, float size);
void add_spheres(scene::Geometry& g, Random& random, int n, float size);
void add_cones(scene::Geometry& g, Random& random, int n, float size);
// Axis-aligned squares on a grid of whole coordinates: floors and walls, many of them coplanar.
void add_architecture(scene::Geometry& g, Random& random, int n);

scene::Geometry mixed_geometry(Random& random, int n, float size);

}  // namespace kdray::test
