// What    What queries are put to: a scene that is ready to be traced, on a device or a part of one.
// Shape   References; whoever asks keeps all of it alive.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "accel/prepare/prepared.h"
#include "device/opencl/context.h"
#include "engine/device_scene/device_scene.h"
#include "engine/wavefront/programs.h"
#include "engine/wavefront/scene_buffers.h"
#include "kdray/options.h"

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
  cl::Buffer masks = {};       // of each primitive, by its number; none: all bits
  std::size_t sub_device = 0;  // the part of the device, by its place in the context
  // How rays walk the tree. Which walks there are in double api/precision.h tells.
  Traversal traversal = Traversal::automatic;
  Precision precision = Precision::float32;
  // Of a scene of doubles: hits are what its filter is sure of (primitives/triangle/filter.clh), whose bounds
  // take a device that rounds divisions correctly.
  bool filters = false;

  // Packets and batches are explicit vectors, for CPUs; elsewhere the lanes are work-items.
  Traversal walk() const { return traversal == Traversal::automatic && global ? Traversal::wide : traversal; }
  const LocalSpace& space_of_rays() const { return space ? *space : scene.geometry.space; }
};

// Of each device, or each of the parts that it is divided into. Uploads the scene where it isn't yet.
std::vector<Target> targets_of(engine::DeviceScene& devices, Traversal traversal = Traversal::automatic,
                               Precision precision = Precision::float32);

}  // namespace kdray::query
