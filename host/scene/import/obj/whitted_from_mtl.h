// What    An MTL material in the terms of the Whitted model. docs/scenes-meshes.md has the table for users.
#pragma once

#include "scene/import/obj/mtl.h"
#include "scene/model/scene.h"

namespace kdray::scene {

// `has_picture`: that of map_Kd is there.
Material whitted_from_mtl(const MtlMaterial& mtl, bool has_picture = false);

}  // namespace kdray::scene
