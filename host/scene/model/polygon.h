// What    Polygons, convex or concave: triangulate() cuts a simple one into triangles by clipping ears
//         (Meisters 1975), add_polygon() adds its triangles to a scene.
// Cost    About n log n, whatever the polygon's shape.
// Errors  None: a polygon that is not simple or has no area still gives n - 2 triangles; one with a corner
//         that is not finite gives them of that corner alone (normals.h). One of over some ten thousand
//         corners that crosses itself all over is cut for a few seconds; its rest becomes a fan, and
//         `finished` false.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/vec.h"
#include "scene/model/scene.h"

namespace kdray::scene {

// Cuts a polygon of n >= 3 corners in order into n - 2 triples of corner numbers, keeping its orientation. A
// polygon whose first corner sees all others (a convex one) becomes the fan of that corner. Corners on a
// straight line become corners of real triangles, not of flat ones, so that neighbours share whole edges.
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const dvec3> corners,
                                                      bool* finished = nullptr);

// Adds a polygon's triangles to a scene, numbered in file order. `corners` index scene.vertices, which must
// be there already when there are more than three; `normals` (into scene.normals) is empty or as long as
// `corners`, and so are `texcoords`. Returns whether triangulate() finished.
bool add_polygon(Scene& scene, std::span<const std::uint32_t> corners, std::span<const std::uint32_t> normals,
                 std::uint32_t material, std::span<const std::array<float, 2>> texcoords = {});

// Returns the warning about a polygon that triangulate() did not finish.
std::string polygon_warning(std::size_t n_corners);

}  // namespace kdray::scene
