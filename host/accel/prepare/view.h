// What    A prepared scene seen in another way: by another camera, before another background, in a studio, or
//         only for what it covers. Trees and primitives are shared with the scene that it was made of.
// Errors  kdray::Error, ErrorCode::usage, as scene/model/frame.h says.
#pragma once

#include <optional>

#include "accel/prepare/prepared.h"
#include "scene/model/frame.h"

namespace kdray::prepare {

// Returns the scene before another camera and background. `aspect`: the picture's width divided by its
// height. `first`: of a film's frames the first one, seen by the same view (scene::set_view).
Prepared seen(const Prepared& prepared, const scene::View& view, double aspect,
              const scene::Scene* first = nullptr);

// Returns the scene in a studio (studio.cpp), as seen() shows it from then on; where its file has a camera or
// lights, `instead` of these, or else the scene itself.
Prepared in_studio(const Prepared& prepared, bool instead = false);

// Returns the scene with everything in it shining in one colour and reflecting nothing, before its own
// background or black. In a picture of depth 1, white on black is what share of each pixel is covered; black
// before the background is what the background itself adds to each pixel.
Prepared shining(const Prepared& prepared, const vec3& emission, bool before_background);

}  // namespace kdray::prepare
