// What    A mesh from arrays in Embree: plain, or with a filter that takes note of every hit and lets the ray
//         go on.
// Shape   Vertices and indices are copied: Embree wants memory behind the last one of buffers that it shares.
// Errors  ErrorCode::internal where Embree refuses it.
#pragma once

#include <memory>

#include "bench/embree/library.h"
#include "bench/workload/arrays.h"

namespace kdray::bench::embree {

// Open as long as a scene of it is.
class OpenDevice {
 public:
  explicit OpenDevice(const Library& library) : library_(library), device_(open(library)) {}
  ~OpenDevice() { library_.release_device(device_); }
  OpenDevice(const OpenDevice&) = delete;
  OpenDevice& operator=(const OpenDevice&) = delete;
  const Library& library() const { return library_; }
  Device get() const { return device_; }

 private:
  const Library& library_;
  Device device_;
};

class ArrayScene {
 public:
  // `filter`: null, or called for every hit of occlusion rays.
  ArrayScene(const std::shared_ptr<OpenDevice>& device, const MeshArrays& mesh, bool robust, Filter filter);
  ~ArrayScene() { device_->library().release_scene(scene_); }
  ArrayScene(const ArrayScene&) = delete;
  ArrayScene& operator=(const ArrayScene&) = delete;

  const Library& library() const { return device_->library(); }
  Scene get() const { return scene_; }

 private:
  std::shared_ptr<OpenDevice> device_;
  Scene scene_;
};

}  // namespace kdray::bench::embree
