// What    An MTL material in the terms of the Whitted model. docs/scenes-meshes.md has the table for users.
#pragma once

#include "scene/mtl.h"
#include "scene/scene.h"

namespace kdray::scene {

Material whitted_from_mtl(const MtlMaterial& mtl);

}  // namespace kdray::scene
