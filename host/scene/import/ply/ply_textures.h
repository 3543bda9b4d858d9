// What    The pictures of a PLY file, as MeshLab and programs of photogrammetry name them: `comment
//         TextureFile NAME`, which faces choose among by `texnumber`.
// Errors  None: a picture that is missing or damaged is left out, with a warning.
#pragma once

#include <string>

#include "scene/import/ply/ply_header.h"
#include "scene/model/scene.h"

namespace kdray::scene::ply {

// Gives the scene, whose triangles have the number of their picture for a material, a material for each.
void lay_on_textures(Scene& scene, const Header& header, const std::string& file);

}  // namespace kdray::scene::ply
