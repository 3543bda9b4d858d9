// What    A scene as it was committed: its tree, what its numbers mean, and the device that answers.
// Shape   It never changes. Who asks holds on to it, so that it lives until the last answer.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "api/device.h"
#include "engine/query/ask.h"
#include "kdray/kdray.h"

namespace kdray::api {

class Committed {
 public:
  Committed(const PreparedScene& scene, query::GeometryTable table, const DeviceOptions& device);
  // All of the scene is geometry 0, as of a file.
  Committed(const PreparedScene& scene, const DeviceOptions& device);
  Committed(const Committed&) = delete;
  Committed& operator=(const Committed&) = delete;

  const PreparedScene& scene() const { return scene_; }
  Picture render(const RenderOptions& options);
  query::QueryContext query_context() { return {target_, table_, frame_, sessions_}; }

  // Of a query over so many rays or points that took this long, and of all that came before it.
  Statistics statistics(std::uint64_t n_asked, std::span<const double> seconds) const;
  double build_seconds() const { return devices_.build_seconds(); }  // compiling, until now
  bool has_compiled() const { return devices_.programs_used().compiled > 0; }

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
