// What    A scene on a device that queries can be put to.
#pragma once

#include <memory>
#include <string>

#include "device/context.h"
#include "prepare/prepared.h"
#include "query/target.h"
#include "scene/scene.h"
#include "wavefront/programs.h"
#include "wavefront/scene_buffers.h"

namespace kdray::test {

class DeviceScene {
 public:
  // `build_options`: for all programs.
  DeviceScene(const scene::Scene& scene, const std::string& device, const std::string& build_options = "",
              const TreeOptions& tree = {});

  query::Target target() { return {context_, buffers_, programs_, prepared_, work_group_, !is_cpu_}; }
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
