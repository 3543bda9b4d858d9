// What    Renders the extra channels (AOVs): one eye ray per pixel, apart from the film.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "film/image.h"
#include "layout/frame.layout.h"
#include "math/local_space.h"
#include "wavefront/programs.h"
#include "wavefront/scene_buffers.h"

namespace kdray::wavefront {

// `names` of "depth", "normal", "primitive", "cost"; throws ErrorCode::usage, naming what there is, for
// others. Depths are the world's; the frame's lengths are those of `space`.
std::vector<film::Channel> render_channels(const device::Context& context, const SceneBuffers& scene,
                                           Programs& programs, const layout::Frame& frame,
                                           const LocalSpace& space, layout::Features features,
                                           Precision precision, std::span<const std::string> names);

}  // namespace kdray::wavefront
