// What    Scenes and points that closest points are hard to find for: of all sizes, thin, far off, with
//         corners and edges that many share, and points in them, far from them, and on or within rounding of
//         their surfaces.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "engine/query/device_scene.h"
#include "scene/model/scene.h"

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

scene::Scene spheres(int n);
scene::Scene cones(int n);
scene::Scene discs(int n);
scene::Scene tori(int n);
scene::Scene all_kinds();

// Triangles alone are moved.
scene::Scene moved(scene::Scene s, double scale, const dvec3& by);

// They are in the world.
std::vector<dvec3> points_for(const DeviceScene& queried, std::size_t n);

}  // namespace kdray::test
