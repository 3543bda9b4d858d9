// What    A heat map: black, indigo, magenta, orange, light yellow, with brightness growing all the way, so
//         that the order of values survives a grey print and colour blindness.
#pragma once

#include "base/vec.h"

namespace kdray::image {

vec3 heat(double share);  // share in [0, 1], clamped; NaN is 0. Linear RGB.

}  // namespace kdray::image
