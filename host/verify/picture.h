// What    A picture of where the findings are: the scene in faint grey, from its own camera and from the
//         opposite side, the findings in colour, and a legend with their numbers.
// Shape   What lies behind something shines through, weaker: no finding is hidden. Faces are filled and,
//         small as they may be, marked by a dot; edges are lines; rays that kdray traced wrongly are crosses.
#pragma once

#include "film/image.h"
#include "prepare/prepared.h"
#include "verify/verify.h"

namespace kdray::verify {

class Tracer;

inline constexpr int kLeastWidth = 320, kLeastHeight = 200;  // of a picture with a legend that can be read

film::Image draw(const Findings& found, const prepare::Prepared& scene, Tracer& tracer, int width,
                 int height);

}  // namespace kdray::verify
