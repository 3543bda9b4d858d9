// What    Scenes and points that closest points are hard to find for: of all sizes, thin, far off, with
//         corners and edges that many share, and points in them, far from them, and on or within rounding of
//         their surfaces.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "conformance/samples.h"
#include "engine/query/device_scene.h"
#include "scene/model/scene.h"
#include "scene/primitives/shapes.h"

namespace kdray::test {

inline constexpr std::uint64_t kClosestSeed = 20261124;

scene::Scene empty_scene();
void add_triangle(scene::Scene& s, const dvec3& a, const dvec3& b, const dvec3& c);

// n triangles of sizes that differ by factors of up to 10^decades.
scene::Scene soup(int n, double decades);

// Long ones, a 10^-2 to 10^-7 of their length across.
scene::Scene slivers(int n);

// A height field over n^2 squares of whole numbers, whose corners and edges its triangles share.
scene::Scene grid(int n);

// About the origin; all of it is equally far from there.
scene::Scene ball(int n);

// Shapes of a kind whose sizes differ by factors of up to 30 beyond those of its samples.
template <class Kind>
scene::Scene shapes(int n) {
  Draw random(kClosestSeed);
  scene::Scene s = empty_scene();
  for (int i = 0; i < n; ++i) {
    Samples<Kind>::add(s, 0, random);
    auto& shape = Kind::of(s).back();
    const dvec3 middle = middle_of(shape);
    const double factor = std::pow(10.0, random.between(-1.5, 0));
    dmat4 matrix(factor);
    matrix[3] = glm::dvec4(middle - factor * middle, 1);
    transform(primitives::Similarity{matrix, factor}, shape);
  }
  return s;
}

scene::Scene flat_cones(int n);  // up to three times as wide as they are high
scene::Scene all_kinds();

// Triangles alone are moved.
scene::Scene moved(scene::Scene s, double scale, const dvec3& by);

// They are in the world.
std::vector<dvec3> points_for(const DeviceScene& queried, std::size_t n);

}  // namespace kdray::test
