#include "bench/embree/array_scene.h"

#include <algorithm>

#include "base/error.h"

namespace kdray::bench::embree {

namespace {

template <class T>
void copy(const Library& embree, Geometry g, BufferType type, Format format, const std::vector<T>& values) {
  void* const memory = embree.set_new_geometry_buffer(g, type, 0, format, 3 * sizeof(T), values.size() / 3);
  if (memory == nullptr) throw Error(ErrorCode::out_of_memory, "no memory for Embree's copy of the mesh");
  std::copy(values.begin(), values.end(), static_cast<T*>(memory));
}

}  // namespace

ArrayScene::ArrayScene(const std::shared_ptr<OpenDevice>& device, const MeshArrays& mesh, bool robust,
                       Filter filter)
    : device_(device), scene_(device->library().new_scene(device->get())) {
  const Library& embree = library();
  embree.set_scene_flags(scene_, robust ? SceneFlags::robust : SceneFlags::none);
  embree.set_scene_build_quality(scene_, BuildQuality::medium);
  const Geometry g = embree.new_geometry(device->get(), GeometryType::triangle);
  copy(embree, g, BufferType::vertex, Format::float3, mesh.vertices);
  copy(embree, g, BufferType::index, Format::uint3, mesh.triangles);
  if (filter != nullptr) embree.set_geometry_occluded_filter_function(g, filter);
  embree.commit_geometry(g);
  embree.attach_geometry(scene_, g);
  embree.release_geometry(g);
  embree.commit_scene(scene_);
  if (embree.get_device_error(device->get()) != 0)
    throw Error(ErrorCode::internal, "Embree refuses the mesh");
}

}  // namespace kdray::bench::embree
