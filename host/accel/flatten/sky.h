// What    A scene's sky -> the arrays of kernels/layout/sky.layout.h; none where it has none.
#pragma once

#include "accel/flatten/flatten.h"
#include "scene/textures/sky.h"

namespace kdray::flatten {

void pack_sky(const scene::Sky& sky, FlatScene& flat);

}  // namespace kdray::flatten
