#include "bench/embree/scenes.h"

#include "base/error.h"
#include "bench/embree/kinds.h"

namespace kdray::bench::embree {

namespace {

template <class Primitives>
void attach(const Library& embree, Device device, Scene into, unsigned id, GeometryType type,
            const Primitives& primitives) {
  if (primitives.empty()) return;
  const Geometry g = embree.new_geometry(device, type);
  fill(embree, g, primitives);
  embree.commit_geometry(g);
  embree.attach_geometry_by_id(into, g, id);
  embree.release_geometry(g);
}

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

Scenes::Scenes(const Library& embree, const scene::Scene& scene) : embree_(embree), device_(open(embree)) {
  const scene::Geometry geometry = scene::make_geometry(scene);
  space_ = geometry.space;
  const auto numbers = [](const scene::Scene& of, const scene::Geometry& g) {
    Numbers all;
    primitives::for_each_kind([&](auto kind) { all[kind.kNumber] = numbers_of(kind, of, g); });
    return all;
  };
  numbers_ = numbers(scene, geometry);
  for (const auto& mesh : scene.meshes) {
    meshes_.push_back(scene::make_geometry(*mesh));
    of_meshes_.push_back(numbers(*mesh, meshes_.back()));
  }
  for (const scene::Instance& instance : scene.instances) mesh_of_.push_back(instance.mesh);
  const auto made = [&](SceneFlags flags) {
    const Scene all = build(geometry, flags);
    add_instances(all, scene, flags);
    finish(all);
    return all;
  };
  fast_ = made(SceneFlags::none);
  robust_ = made(SceneFlags::robust);
  meshes_.clear();
}

Scenes::~Scenes() {
  embree_.release_scene(fast_);
  embree_.release_scene(robust_);
  embree_.release_device(device_);
}

Scene Scenes::build(const scene::Geometry& geometry, SceneFlags flags) const {
  const Scene made = embree_.new_scene(device_);
  embree_.set_scene_flags(made, flags);
  embree_.set_scene_build_quality(made, BuildQuality::medium);
  primitives::for_each_kind([&](auto kind) {
    if constexpr (kEmbreeHas<decltype(kind)>)
      attach(embree_, device_, made, kind.kNumber, embree_type(kind), decltype(kind)::of(geometry));
    else
      refuse_any(kind, geometry);
  });
  return made;
}

// Instances hold their meshes' scenes.
void Scenes::add_instances(Scene into, const scene::Scene& scene, SceneFlags flags) const {
  std::vector<Scene> meshes;
  for (const scene::Geometry& mesh : meshes_) finish(meshes.emplace_back(build(mesh, flags)));
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const LocalSpace& of_mesh = meshes_[instance.mesh].space;
    const dmat3 linear = instance.linear * (space_.scale / of_mesh.scale);
    const dvec3 move = space_.local(instance.point(of_mesh.center));
    float columns[12];
    for (int k = 0; k < 3; ++k) {
      for (int column = 0; column < 3; ++column)
        columns[3 * column + k] = static_cast<float>(linear[column][k]);
      columns[9 + k] = static_cast<float>(move[k]);
    }
    const Geometry g = embree_.new_geometry(device_, GeometryType::instance);
    embree_.set_geometry_instanced_scene(g, meshes[instance.mesh]);
    embree_.set_geometry_transform(g, 0, Format::float3x4_column_major, columns);
    embree_.commit_geometry(g);
    embree_.attach_geometry_by_id(into, g, kFirstInstance + static_cast<unsigned>(i));
    embree_.release_geometry(g);
  }
  for (const Scene mesh : meshes) embree_.release_scene(mesh);
}

void Scenes::finish(Scene made) const {
  embree_.commit_scene(made);
  if (embree_.get_device_error(device_) != 0) throw Error(ErrorCode::internal, "Embree refuses the scene");
}

}  // namespace kdray::bench::embree
