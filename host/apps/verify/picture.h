// What    A picture of where the findings are: the scene in faint grey, from its own camera and from the
//         opposite side, the findings in colour.
// Shape   What lies behind something shines through, weaker: no finding is hidden. Faces are filled and,
//         small as they may be, marked by a dot; edges are lines; rays that kdray traced wrongly are crosses.
#pragma once

#include <string>

#include "accel/prepare/prepared.h"
#include "apps/verify/verify.h"
#include "io/image/image.h"

namespace kdray::verify {

class Tracer;

inline constexpr int kLeastWidth = 320, kLeastHeight = 200;  // of a picture on which something can be seen

image::Image draw(const Findings& found, const prepare::Prepared& scene, Tracer& tracer, int width,
                  int height);

// Which colours the picture has and what they mark: "red: open edges, blue: ..."; empty where there are none.
std::string colors_of(const Findings& found);

}  // namespace kdray::verify
