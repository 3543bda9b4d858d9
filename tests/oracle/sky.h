// What    What rays that meet nothing see of a gradient or a picture all around, by the textbook, in double.
#pragma once

#include "scene/textures/sky.h"

namespace kdray::oracle {

dvec3 gradient(const scene::Sky& sky, double height);
dvec3 sky_picture(const scene::Sky& sky, const dvec3& direction);  // of unit length

}  // namespace kdray::oracle
