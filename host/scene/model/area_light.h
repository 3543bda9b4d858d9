// What    Lights with an area, from what files and programs say of them.
#pragma once

#include "scene/model/scene.h"

namespace kdray::scene {

// A disc's two radii at right angles to its normal, which has unit length, and to each other.
void set_disc(Light& light, const dvec3& normal, double radius);

}  // namespace kdray::scene
