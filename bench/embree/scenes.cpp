#include "bench/embree/scenes.h"

#include "base/error.h"

namespace kdray::bench::embree {

namespace {

template <class Kind>
std::vector<std::uint32_t> numbers_of(Kind, const scene::Scene& scene, const scene::Geometry& geometry) {
  std::vector<std::uint32_t> numbers;
  for (const auto& p : Kind::of(geometry)) {
    if constexpr (Kind::kIsShape)
      numbers.push_back(Kind::of(scene)[p.source].number);
    else
      numbers.push_back(p.number);
  }
  return numbers;
}

}  // namespace

OwnedScene::OwnedScene(std::shared_ptr<const OpenDevice> device, bool robust)
    : device_(std::move(device)), scene_(library().new_scene(device_->get())) {
  library().set_scene_flags(scene_, robust ? SceneFlags::robust : SceneFlags::none);
  library().set_scene_build_quality(scene_, BuildQuality::medium);
}

void OwnedScene::add(const KindBuffers& buffers, Filter filter) {
  primitives::for_each_kind([&](auto kind) {
    const Buffers& b = buffers[kind.kNumber];
    if (b.n_vertices == 0) return;
    const Geometry g = library().new_geometry(device_->get(), embree_type(kind));
    share(library(), g, b, kind.kIsShape);
    if (filter != nullptr) library().set_geometry_occluded_filter_function(g, filter);
    attach(g, kind.kNumber);
  });
}

void OwnedScene::add_instance(const OwnedScene& of, const float (&columns)[12], unsigned number) {
  const Geometry g = library().new_geometry(device_->get(), GeometryType::instance);
  library().set_geometry_instanced_scene(g, of.get());
  library().set_geometry_transform(g, 0, Format::float3x4_column_major, columns);
  attach(g, number);
}

void OwnedScene::attach(Geometry geometry, unsigned number) {
  library().commit_geometry(geometry);
  library().attach_geometry_by_id(scene_, geometry, number);
  library().release_geometry(geometry);
}

void OwnedScene::commit() {
  library().commit_scene(scene_);
  if (library().get_device_error(device_->get()) != 0)
    throw Error(ErrorCode::internal, "Embree refuses the scene");
}

Scenes::Part::Part(const scene::Scene& scene, const scene::Geometry& geometry)
    : space(geometry.space), buffers(buffers_of(scene, geometry)) {
  primitives::for_each_kind([&](auto kind) { numbers[kind.kNumber] = numbers_of(kind, scene, geometry); });
}

Scenes::Scenes(const Library& embree, const scene::Scene& scene)
    : device_(std::make_shared<OpenDevice>(embree)), own_(scene, scene::make_geometry(scene)) {
  for (const auto& mesh : scene.meshes)
    meshes_.push_back(std::make_unique<Part>(*mesh, scene::make_geometry(*mesh)));
  for (const scene::Instance& instance : scene.instances) mesh_of_.push_back(instance.mesh);
  fast_ = make(scene, false);
  robust_ = make(scene, true);
}

// Instances hold their meshes' scenes.
std::unique_ptr<OwnedScene> Scenes::make(const scene::Scene& scene, bool robust) const {
  auto made = std::make_unique<OwnedScene>(device_, robust);
  made->add(own_.buffers);
  std::vector<std::unique_ptr<OwnedScene>> meshes;
  for (const auto& mesh : meshes_) {
    meshes.push_back(std::make_unique<OwnedScene>(device_, robust));
    meshes.back()->add(mesh->buffers);
    meshes.back()->commit();
  }
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const LocalSpace& of_mesh = meshes_[instance.mesh]->space;
    const dmat3 linear = instance.linear * (space().scale / of_mesh.scale);
    const dvec3 move = space().local(instance.point(of_mesh.center));
    float columns[12];
    for (int k = 0; k < 3; ++k) {
      for (int column = 0; column < 3; ++column)
        columns[3 * column + k] = static_cast<float>(linear[column][k]);
      columns[9 + k] = static_cast<float>(move[k]);
    }
    made->add_instance(*meshes[instance.mesh], columns, kFirstInstance + static_cast<unsigned>(i));
  }
  made->commit();
  return made;
}

}  // namespace kdray::bench::embree
