// What    What a glTF file has besides what is read, by name and number, so that nobody misses it unawares:
//         extensions, scenes, animations while the file is at rest, sets of coordinates and colours.
// Shape   Materials and textures tell of their own (gltf_materials.h, gltf_textures.h).
#pragma once

#include <string>
#include <vector>

#include "scene/import/gltf/gltf_document.h"

namespace kdray::scene::gltf {

std::vector<std::string> left_out_of(Document& document, bool at_rest);

}  // namespace kdray::scene::gltf
