#include "bench/embree/scenes.h"

#include "base/error.h"
#include "bench/embree/kinds.h"

namespace kdray::bench {

namespace {

template <class Primitives>
void attach(RTCDevice device, RTCScene into, unsigned id, RTCGeometryType type,
            const Primitives& primitives) {
  if (primitives.empty()) return;
  const RTCGeometry g = rtcNewGeometry(device, type);
  fill(g, primitives);
  rtcCommitGeometry(g);
  rtcAttachGeometryByID(into, g, id);
  rtcReleaseGeometry(g);
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

RTCDevice open_embree() {
  const RTCDevice device = rtcNewDevice("frequency_level=simd512");
  if (device == nullptr) throw Error(ErrorCode::internal, "Embree gives no device");
  return device;
}

EmbreeScenes::EmbreeScenes(const scene::Scene& scene) : device_(open_embree()) {
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
  const auto made = [&](RTCSceneFlags flags) {
    const RTCScene all = build(geometry, flags);
    add_instances(all, scene, flags);
    finish(all);
    return all;
  };
  fast_ = made(RTC_SCENE_FLAG_NONE);
  robust_ = made(RTC_SCENE_FLAG_ROBUST);
  meshes_.clear();
}

EmbreeScenes::~EmbreeScenes() {
  rtcReleaseScene(fast_);
  rtcReleaseScene(robust_);
  rtcReleaseDevice(device_);
}

RTCScene EmbreeScenes::build(const scene::Geometry& geometry, RTCSceneFlags flags) const {
  const RTCScene made = rtcNewScene(device_);
  rtcSetSceneFlags(made, flags);
  rtcSetSceneBuildQuality(made, RTC_BUILD_QUALITY_MEDIUM);
  primitives::for_each_kind([&](auto kind) {
    if constexpr (kEmbreeHas<decltype(kind)>)
      attach(device_, made, kind.kNumber, embree_type(kind), decltype(kind)::of(geometry));
    else
      refuse_any(kind, geometry);
  });
  return made;
}

// Instances hold their meshes' scenes.
void EmbreeScenes::add_instances(RTCScene into, const scene::Scene& scene, RTCSceneFlags flags) const {
  std::vector<RTCScene> meshes;
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
    const RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(g, meshes[instance.mesh]);
    rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(into, g, kFirstInstance + static_cast<unsigned>(i));
    rtcReleaseGeometry(g);
  }
  for (const RTCScene mesh : meshes) rtcReleaseScene(mesh);
}

void EmbreeScenes::finish(RTCScene made) const {
  rtcCommitScene(made);
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE)
    throw Error(ErrorCode::internal, "Embree refuses the scene");
}

}  // namespace kdray::bench
