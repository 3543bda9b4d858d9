#include "wavefront/scene_buffers.h"

#include <memory>

#include "device/opencl_error.h"

namespace kdray::wavefront {

namespace {

struct Piece {
  const void* data = nullptr;
  std::size_t bytes = 0;
  std::shared_ptr<void> owner;
};

template <class T>
Piece piece_of(const Array<T>& items) {
  return {items.data(), items.bytes(), items.owner()};
}

std::array<Piece, SceneBuffers::kArrays> pieces_of(const flatten::FlatScene& flat,
                                                   const flatten::WideForm& wide) {
  return {piece_of(flat.nodes),           piece_of(flat.refs),          piece_of(flat.triangles),
          piece_of(flat.normals),         piece_of(flat.spheres),       piece_of(flat.cones),
          piece_of(flat.materials),       piece_of(flat.lights),        piece_of(wide.nodes),
          piece_of(wide.triangle_blocks), piece_of(wide.sphere_blocks), piece_of(wide.cone_blocks)};
}

const char* const kNames[SceneBuffers::kArrays] = {"the kd-tree's nodes",   "the kd-tree's references",
                                                   "the triangles",         "the vertex normals",
                                                   "the spheres",           "the cones",
                                                   "the materials",         "the lights",
                                                   "the wide tree's nodes", "the leaves' triangles",
                                                   "the leaves' spheres",   "the leaves' cones"};

}  // namespace

std::array<cl::Buffer*, SceneBuffers::kArrays> SceneBuffers::all() {
  return {&nodes,     &refs,   &triangles,  &normals,         &spheres,       &cones,
          &materials, &lights, &wide_nodes, &triangle_blocks, &sphere_blocks, &cone_blocks};
}

SceneBuffers::SceneBuffers(const device::Context& context, const flatten::FlatScene& flat,
                           const flatten::WideForm& wide) {
  const auto pieces = pieces_of(flat, wide);
  const auto buffers = all();
  for (std::size_t i = 0; i < kArrays; ++i)
    *buffers[i] = context.upload(pieces[i].data, pieces[i].bytes, pieces[i].owner, kNames[i]);
}

SceneBuffers::SceneBuffers(const device::Context& context, const Sizes& sizes) {
  const auto buffers = all();
  for (std::size_t i = 0; i < kArrays; ++i)
    *buffers[i] = context.buffer(CL_MEM_READ_ONLY, sizes[i], kNames[i]);
}

SceneBuffers::Sizes SceneBuffers::sizes_of(const flatten::FlatScene& flat, const flatten::WideForm& wide) {
  Sizes sizes;
  const auto pieces = pieces_of(flat, wide);
  for (std::size_t i = 0; i < kArrays; ++i) sizes[i] = pieces[i].bytes;
  return sizes;
}

void SceneBuffers::copy(cl::CommandQueue& queue, const flatten::FlatScene& flat,
                        const flatten::WideForm& wide) {
  const auto pieces = pieces_of(flat, wide);
  const auto buffers = all();
  device::checked("uploading the scene", [&] {
    for (std::size_t i = 0; i < kArrays; ++i)
      if (pieces[i].bytes > 0)
        queue.enqueueWriteBuffer(*buffers[i], CL_FALSE, 0, pieces[i].bytes, pieces[i].data);
    queue.finish();
  });
}

cl_uint SceneBuffers::set_tree_arguments(cl::Kernel& kernel) const {
  cl_uint index = 0;
  for (const cl::Buffer* buffer : {&nodes, &refs, &triangles, &spheres, &cones, &wide_nodes, &triangle_blocks,
                                   &sphere_blocks, &cone_blocks})
    kernel.setArg(index++, *buffer);
  return index;
}

}  // namespace kdray::wavefront
