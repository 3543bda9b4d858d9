#include "wavefront/scene_buffers.h"

namespace kdray::wavefront {

namespace {

template <class T>
cl::Buffer upload(const device::Context& context, const Array<T>& items, const std::string& what) {
  return context.upload(items.data(), items.bytes(), items.owner(), what);
}

}  // namespace

SceneBuffers::SceneBuffers(const device::Context& context, const flatten::FlatScene& flat,
                           const flatten::WideForm& wide)
    : nodes(upload(context, flat.nodes, "the kd-tree's nodes")),
      refs(upload(context, flat.refs, "the kd-tree's references")),
      triangles(upload(context, flat.triangles, "the triangles")),
      normals(upload(context, flat.normals, "the vertex normals")),
      spheres(upload(context, flat.spheres, "the spheres")),
      cones(upload(context, flat.cones, "the cones")),
      materials(upload(context, flat.materials, "the materials")),
      lights(upload(context, flat.lights, "the lights")),
      wide_nodes(upload(context, wide.nodes, "the wide tree's nodes")),
      triangle_blocks(upload(context, wide.triangle_blocks, "the leaves' triangles")),
      sphere_blocks(upload(context, wide.sphere_blocks, "the leaves' spheres")),
      cone_blocks(upload(context, wide.cone_blocks, "the leaves' cones")) {}

cl_uint SceneBuffers::set_tree_arguments(cl::Kernel& kernel) const {
  cl_uint index = 0;
  for (const cl::Buffer* buffer : {&nodes, &refs, &triangles, &spheres, &cones, &wide_nodes, &triangle_blocks,
                                   &sphere_blocks, &cone_blocks})
    kernel.setArg(index++, *buffer);
  return index;
}

}  // namespace kdray::wavefront
