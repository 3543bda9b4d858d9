// What    A mesh from arrays in Embree: plain, or with a filter that takes note of every hit and lets the ray
//         go on.
// Shape   Vertices and indices are copied: Embree wants memory behind the last one of buffers that it shares.
// Errors  ErrorCode::internal where Embree refuses it.
#pragma once

#include <memory>

#include "bench/embree/api.h"
#include "bench/workload/arrays.h"

namespace kdray::bench {

// Open as long as a scene of it is.
class EmbreeDevice {
 public:
  EmbreeDevice();
  ~EmbreeDevice() { rtcReleaseDevice(device_); }
  EmbreeDevice(const EmbreeDevice&) = delete;
  EmbreeDevice& operator=(const EmbreeDevice&) = delete;
  RTCDevice get() const { return device_; }

 private:
  RTCDevice device_;
};

class ArrayScene {
 public:
  // `filter`: null, or called for every hit of occlusion rays.
  ArrayScene(const std::shared_ptr<EmbreeDevice>& device, const MeshArrays& mesh, bool robust,
             RTCFilterFunctionN filter);
  ~ArrayScene() { rtcReleaseScene(scene_); }
  ArrayScene(const ArrayScene&) = delete;
  ArrayScene& operator=(const ArrayScene&) = delete;

  RTCScene get() const { return scene_; }

 private:
  std::shared_ptr<EmbreeDevice> device_;
  RTCScene scene_;
};

}  // namespace kdray::bench
