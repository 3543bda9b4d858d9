#include "wavefront/scene_buffers.h"

#include "device/opencl_error.h"

namespace kdray::wavefront {

namespace {

class Upload {
 public:
  Upload(const device::Context& context, Placement placement) : context_(context), placement_(placement) {}

  template <class T>
  cl::Buffer operator()(const Array<T>& items, const std::string& what) const {
    return placement_ == Placement::copied
               ? context_.upload_unawaited(items.data(), items.bytes(), what)
               : context_.upload(items.data(), items.bytes(), items.owner(), what);
  }

 private:
  const device::Context& context_;
  const Placement placement_;
};

}  // namespace

SceneBuffers::SceneBuffers(const device::Context& context, const flatten::FlatScene& flat,
                           const flatten::WideForm& wide, Placement placement) {
  const Upload upload(context, placement);
  nodes = upload(flat.nodes, "the kd-tree's nodes");
  refs = upload(flat.refs, "the kd-tree's references");
  triangles = upload(flat.triangles, "the triangles");
  normals = upload(flat.normals, "the vertex normals");
  spheres = upload(flat.spheres, "the spheres");
  cones = upload(flat.cones, "the cones");
  materials = upload(flat.materials, "the materials");
  lights = upload(flat.lights, "the lights");
  wide_nodes = upload(wide.nodes, "the wide tree's nodes");
  triangle_blocks = upload(wide.triangle_blocks, "the leaves' triangles");
  sphere_blocks = upload(wide.sphere_blocks, "the leaves' spheres");
  cone_blocks = upload(wide.cone_blocks, "the leaves' cones");
  if (placement == Placement::copied)
    device::checked("uploading the scene", [&] { context.queues().front().finish(); });
}

cl_uint SceneBuffers::set_tree_arguments(cl::Kernel& kernel) const {
  cl_uint index = 0;
  for (const cl::Buffer* buffer : {&nodes, &refs, &triangles, &spheres, &cones, &wide_nodes, &triangle_blocks,
                                   &sphere_blocks, &cone_blocks})
    kernel.setArg(index++, *buffer);
  return index;
}

}  // namespace kdray::wavefront
