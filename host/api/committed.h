// What    A scene as it was committed: its tree, what its numbers mean, and the device that answers.
// Shape   It never changes. Who asks holds on to it, so that it lives until the last answer.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "api/device.h"
#include "kdray/kdray.h"
#include "query/ask.h"

namespace kdray::api {

class Committed {
 public:
  Committed(const PreparedScene& scene, query::GeometryTable table, const DeviceOptions& device);
  Committed(const Committed&) = delete;
  Committed& operator=(const Committed&) = delete;

  const PreparedScene& scene() const { return scene_; }
  Picture render(const RenderOptions& options);
  query::Asked asked() { return {target_, table_, frame_, sessions_}; }

 private:
  query::Target target();

  PreparedScene scene_;
  query::GeometryTable table_;
  query::LocalFrame frame_;
  DeviceSet devices_;
  query::Target target_;
  query::AllSessions sessions_;
  DeviceOptions device_options_;
  std::mutex rendering_;
  std::optional<Renderer> renderer_;  // once a picture was asked for
};

}  // namespace kdray::api
