// What    A flattened scene on the device; shared by all queues of a context, read only. Where the device works in the host's
//         memory, the buffers are the arrays themselves, unless a copy is asked for.
#pragma once

#include "device/context.h"
#include "flatten/flatten.h"
#include "flatten/wide.h"

namespace kdray::wavefront {

enum class Placement { in_place_if_possible, copied };

struct SceneBuffers {
  cl::Buffer nodes, refs, triangles, normals, spheres, cones, materials, lights;
  cl::Buffer wide_nodes, triangle_blocks, sphere_blocks, cone_blocks;

  SceneBuffers(const device::Context& context, const flatten::FlatScene& flat, const flatten::WideForm& wide,
               Placement placement = Placement::in_place_if_possible);

  // Sets KDRAY_SCENE_PARAMETERS (kernels/traverse/scene.clh) as the kernel's first arguments; the next free index.
  cl_uint set_tree_arguments(cl::Kernel& kernel) const;
};

}  // namespace kdray::wavefront
