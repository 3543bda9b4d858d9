// What    What queries are put to: a scene that is ready to be traced, on a device.
// Shape   References; whoever asks keeps all of it alive.
#pragma once

#include <cstddef>
#include <optional>

#include "accel/prepare/prepared.h"
#include "device/opencl/context.h"
#include "engine/wavefront/programs.h"
#include "engine/wavefront/scene_buffers.h"

namespace kdray::query {

struct Target {
  const device::Context& context;
  const wavefront::SceneBuffers& buffers;
  wavefront::Programs& programs;
  const prepare::Prepared& scene;
  std::size_t work_group;  // local size of kernels that take a ray to a work-item
  bool global = false;     // launches are to be short, and every lane is a work-item: a GPU
  // The space that rays are given in, as the scene's own is in the world's; none: the world's.
  std::optional<LocalSpace> space = {};
  cl::Buffer masks = {};  // of each primitive, by its number; none: all bits

  const LocalSpace& space_of_rays() const { return space ? *space : scene.geometry.space; }
};

}  // namespace kdray::query
