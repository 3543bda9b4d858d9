#include "bench/embree/scenes.h"

#include <span>

#include "base/error.h"

namespace kdray::bench {

namespace {

template <class T>
T* new_buffer(RTCGeometry g, RTCBufferType type, RTCFormat format, std::size_t stride, std::size_t n) {
  void* const memory = rtcSetNewGeometryBuffer(g, type, 0, format, stride, n);
  if (memory == nullptr) throw Error(ErrorCode::out_of_memory, "no memory for Embree's copy of the scene");
  return static_cast<T*>(memory);
}

void fill(RTCGeometry g, std::span<const scene::TriangleGeometry> triangles) {
  auto* point =
      new_buffer<vec3>(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof(vec3), 3 * triangles.size());
  auto* index = new_buffer<std::uint32_t>(g, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                          3 * sizeof(std::uint32_t), triangles.size());
  for (const scene::TriangleGeometry& t : triangles)
    for (int i = 0; i < 3; ++i) *point++ = scene::vertex(t, i);
  for (std::uint32_t i = 0; i < 3 * triangles.size(); ++i) index[i] = i;
}

void fill(RTCGeometry g, const std::vector<scene::SphereGeometry>& spheres) {
  auto* point =
      new_buffer<glm::vec4>(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, sizeof(glm::vec4), spheres.size());
  for (const scene::SphereGeometry& s : spheres) *point++ = {s.center, s.radius};
}

void fill(RTCGeometry g, const std::vector<scene::ConeGeometry>& cones) {
  auto* point = new_buffer<glm::vec4>(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, sizeof(glm::vec4),
                                      2 * cones.size());
  auto* index = new_buffer<std::uint32_t>(g, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT, sizeof(std::uint32_t),
                                          cones.size());
  auto* flags = new_buffer<std::uint8_t>(g, RTC_BUFFER_TYPE_FLAGS, RTC_FORMAT_UCHAR, 1, cones.size());
  for (std::uint32_t i = 0; i < cones.size(); ++i) {
    point[2 * i] = {cones[i].base, cones[i].base_radius};
    point[2 * i + 1] = {cones[i].apex, cones[i].apex_radius};
    index[i] = 2 * i;
    flags[i] = kOpenCone;
  }
}

void fill(RTCGeometry g, const std::vector<scene::DiscGeometry>& discs) {
  auto* point =
      new_buffer<glm::vec4>(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, sizeof(glm::vec4), discs.size());
  auto* normal = new_buffer<vec3>(g, RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, sizeof(vec3), discs.size());
  for (const scene::DiscGeometry& d : discs) *point++ = {d.center, d.radius}, *normal++ = d.normal;
}

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
