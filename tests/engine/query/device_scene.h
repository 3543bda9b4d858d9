// What    A scene on a device that queries can be put to.
#pragma once

#include <memory>
#include <string>

#include "accel/prepare/prepared.h"
#include "device/opencl/context.h"
#include "engine/query/target.h"
#include "engine/wavefront/programs.h"
#include "engine/wavefront/scene_buffers.h"
#include "scene/model/scene.h"

namespace kdray::test {

class DeviceScene {
 public:
  // `build_options`: for all programs.
  DeviceScene(const scene::Scene& scene, const std::string& device, const std::string& build_options = "",
              const TreeOptions& tree = {});

  query::Target target(Traversal walk = Traversal::automatic) {
    query::Target target{context_, buffers_, programs_, prepared_, work_group_, !is_cpu_};
    target.traversal = walk;
    return target;
  }
  const prepare::Prepared& prepared() const { return prepared_; }
  const LocalSpace& space() const { return prepared_.geometry.space; }

 private:
  prepare::Prepared prepared_;
  device::Context context_;
  wavefront::SceneBuffers buffers_;
  wavefront::Programs programs_;
  bool is_cpu_;
  std::size_t work_group_;
};

}  // namespace kdray::test
