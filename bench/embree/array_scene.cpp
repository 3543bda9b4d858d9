#include "bench/embree/array_scene.h"

#include <algorithm>

#include "base/error.h"
#include "bench/embree/scenes.h"

namespace kdray::bench {

namespace {

template <class T>
void copy(RTCGeometry g, RTCBufferType type, RTCFormat format, const std::vector<T>& values) {
  void* const memory = rtcSetNewGeometryBuffer(g, type, 0, format, 3 * sizeof(T), values.size() / 3);
  if (memory == nullptr) throw Error(ErrorCode::out_of_memory, "no memory for Embree's copy of the mesh");
  std::copy(values.begin(), values.end(), static_cast<T*>(memory));
}

}  // namespace

EmbreeDevice::EmbreeDevice() : device_(open_embree()) {}

ArrayScene::ArrayScene(const std::shared_ptr<EmbreeDevice>& device, const MeshArrays& mesh, bool robust,
                       RTCFilterFunctionN filter)
    : device_(device), scene_(rtcNewScene(device->get())) {
  rtcSetSceneFlags(scene_, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_MEDIUM);
  const RTCGeometry g = rtcNewGeometry(device->get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  copy(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.vertices);
  copy(g, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangles);
  if (filter != nullptr) rtcSetGeometryOccludedFilterFunction(g, filter);
  rtcCommitGeometry(g);
  rtcAttachGeometry(scene_, g);
  rtcReleaseGeometry(g);
  rtcCommitScene(scene_);
  if (rtcGetDeviceError(device->get()) != RTC_ERROR_NONE)
    throw Error(ErrorCode::internal, "Embree refuses the mesh");
}

}  // namespace kdray::bench
