// What    A flattened scene on the device; shared by all queues of a context, read only. Where the device
//         works in the host's memory, the buffers are the arrays themselves; or they are room that scenes are
//         copied to, one after the other.
#pragma once

#include <array>

#include "device/context.h"
#include "flatten/flatten.h"
#include "flatten/wide.h"

namespace kdray::wavefront {

struct SceneBuffers {
  static constexpr std::size_t kArrays = 12;
  using Sizes = std::array<std::size_t, kArrays>;  // bytes, in the order of the members
  static constexpr std::size_t kMaterials = 6, kLights = 7;

  cl::Buffer nodes, refs, triangles, normals, spheres, cones, materials, lights;
  cl::Buffer wide_nodes, triangle_blocks, sphere_blocks, cone_blocks;

  SceneBuffers(const device::Context& context, const flatten::FlatScene& flat, const flatten::WideForm& wide);
  // Room for arrays of these sizes.
  SceneBuffers(const device::Context& context, const Sizes& sizes);

  static Sizes sizes_of(const flatten::FlatScene& flat, const flatten::WideForm& wide);

  // Copies a scene that there is room for, and waits for it.
  void copy(cl::CommandQueue& queue, const flatten::FlatScene& flat, const flatten::WideForm& wide);

  // Sets KDRAY_SCENE_PARAMETERS (kernels/traverse/scene.clh) as the kernel's first arguments; the next free
  // index.
  cl_uint set_tree_arguments(cl::Kernel& kernel) const;

 private:
  std::array<cl::Buffer*, kArrays> all();
};

}  // namespace kdray::wavefront
