// What    Adds a polygon's triangles to a scene, numbered in file order; a concave one is cut by
//         triangulate().
// Shape   `corners` index scene.vertices, which must be there already when there are more than three;
//         `normals` (into scene.normals) is empty or as long as `corners`, and so are `texcoords`. A
//         polygon that can't be cut up well is told in scene.warnings.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "scene/model/scene.h"

namespace kdray::scene {

void add_polygon(Scene& scene, std::span<const std::uint32_t> corners, std::span<const std::uint32_t> normals,
                 std::uint32_t material, std::span<const std::array<float, 2>> texcoords = {});

// What the user is told of one that triangulate() did not finish.
std::string polygon_warning(std::size_t n_corners);

}  // namespace kdray::scene
