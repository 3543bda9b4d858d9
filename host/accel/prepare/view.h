// What    A prepared scene seen otherwise: by another camera, before another background, or only for what it
//         covers. Trees and primitives are shared with the scene that it was made of.
// Errors  kdray::Error, ErrorCode::usage, as scene/view.h says.
#pragma once

#include <optional>

#include "accel/prepare/prepared.h"
#include "scene/model/view.h"

namespace kdray::prepare {

// `aspect`: width by height of the picture that is going to be made.
Prepared seen(const Prepared& prepared, const scene::View& view, const std::optional<vec3>& background,
              double aspect);

// All that is there shines white, on black: a picture is the share of each pixel that is covered, when rays
// go no further than to what they hit first.
Prepared coverage_of(const Prepared& prepared);

}  // namespace kdray::prepare
