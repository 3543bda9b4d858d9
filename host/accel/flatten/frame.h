// What    Camera and settings -> layout::Frame, in the space of the tree.
#pragma once

#include <string>

#include "kdray/options.h"
#include "layout/frame.layout.h"
#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::flatten {

// Returns the settings of a render with every default filled in: the options, then what the scene asks for,
// then kdray's own. Throws ErrorCode::usage for a picture of no size or of over 2^31 pixels, for a part that
// does not lie in it, and for depths and samples out of range.
RenderOptions resolved(const RenderOptions& options, const scene::RenderSettings& settings);

// Returns "200x100+30+40".
std::string in_words(const PixelRect& part);

// Returns a bound on the light that any ray of the scene can bring back at `depth` levels: what one hit can
// show, times the geometric sum of the largest share that a material passes on. Infinite where a light grows
// without bound (fall-off without constant term).
double radiance_bound(const scene::Scene& scene, int depth);

// Returns the part of Frame that comes from scene and resolved options; the schedule's fields (tiles, batch,
// pool) stay 0.
layout::Frame make_frame(const scene::Scene& scene, const scene::Geometry& geometry,
                         const RenderOptions& options);

}  // namespace kdray::flatten
