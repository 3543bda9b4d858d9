// What    Geometry for the tests of the tree: random, regular and hostile, all from a seed.
// Shape   Triangles have coordinates of a few bits (multiples of 2^-16 below 2^7), so that points on them are
//         exact. The shapes are the conformance samples (conformance/samples.h), moved.
#pragma once

#include <random>

#include "conformance/samples.h"
#include "scene/model/geometry.h"

namespace kdray::test {

using Random = std::mt19937_64;

float uniform(Random& random, float lo, float hi);
vec3 random_vec3(Random& random, float lo, float hi);  // multiples of 2^-16

void add_triangle(scene::Geometry& g, const vec3& a, const vec3& b, const vec3& c);
void add_triangles(scene::Geometry& g, Random& random, int n, float size);

// n of a kind, the largest about as large as `size`.
template <class Kind>
void add_primitives(Kind, scene::Geometry& g, Random& random, int n, float size) {
  if constexpr (!Kind::kIsShape) {
    add_triangles(g, random, n, size);
  } else {
    auto& all = Kind::of(g);
    Draw draw(random());
    for (const std::size_t wanted = all.size() + static_cast<std::size_t>(n); all.size() < wanted;) {
      scene::Scene one;
      Samples<Kind>::add(one, 0, draw);
      auto shape = Kind::of(one).front();
      const dvec3 middle = middle_of(shape);
      dmat4 place(size);
      place[3] = glm::dvec4((8.0 - size) * middle, 1);
      transform(primitives::Similarity{place, size}, shape);
      const auto kept = geometry_of(shape, LocalSpace{}, static_cast<std::uint32_t>(all.size()));
      if (has_area(kept)) all.push_back(kept);
    }
  }
}

// Axis-aligned squares on a grid of whole coordinates: floors and walls, many of them coplanar.
void add_architecture(scene::Geometry& g, Random& random, int n);

// n triangles, and half as many of each other kind.
scene::Geometry mixed_geometry(Random& random, int n, float size);

}  // namespace kdray::test
