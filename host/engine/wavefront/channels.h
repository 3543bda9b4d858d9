// What    Renders the extra channels (AOVs): one eye ray per pixel, apart from the film.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/local_space.h"
#include "engine/wavefront/programs.h"
#include "engine/wavefront/scene_buffers.h"
#include "io/image/image.h"
#include "layout/frame.layout.h"

namespace kdray::wavefront {

// A queue of a device that has the scene.
struct ChannelQueue {
  const device::Context& context;
  const SceneBuffers& scene;
  Programs& programs;
  cl::CommandQueue queue;
};

// Throws ErrorCode::usage, naming what there is, for a name that is no channel's.
void check_channels(std::span<const std::string> names);

// `names` of "depth", "normal" (which makes three), "primitive", "instance", "cost". Depths are the world's;
// the frame's lengths are those of `space`. The queues, of one scene, share the pixels.
std::vector<image::Channel> render_channels(std::span<const ChannelQueue> queues, const layout::Frame& frame,
                                            const LocalSpace& space, layout::Features features,
                                            Precision precision, std::span<const std::string> names);

}  // namespace kdray::wavefront
