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
  primitives::for_each_kind([&](auto kind) { numbers_[kind.kNumber] = numbers_of(kind, scene, geometry); });
  fast_ = build(geometry, RTC_SCENE_FLAG_NONE);
  robust_ = build(geometry, RTC_SCENE_FLAG_ROBUST);
}

EmbreeScenes::~EmbreeScenes() {
  rtcReleaseScene(fast_);
  rtcReleaseScene(robust_);
  rtcReleaseDevice(device_);
}

RTCScene EmbreeScenes::build(const scene::Geometry& geometry, RTCSceneFlags flags) {
  const RTCScene made = rtcNewScene(device_);
  rtcSetSceneFlags(made, flags);
  rtcSetSceneBuildQuality(made, RTC_BUILD_QUALITY_MEDIUM);
  primitives::for_each_kind([&](auto kind) {
    attach(device_, made, kind.kNumber, embree_type(kind), decltype(kind)::of(geometry));
  });
  rtcCommitScene(made);
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE)
    throw Error(ErrorCode::internal, "Embree refuses the scene");
  return made;
}

}  // namespace kdray::bench
