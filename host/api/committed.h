// What    A scene as it was committed: its tree, what its numbers mean, and the devices that answer.
// Shape   Never changes. Each call holds a reference, so it lives until the last answer.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "engine/device_scene/device_scene.h"
#include "engine/query/queries.h"
#include "kdray/kdray.h"

namespace kdray::api {

// How rays are to walk the tree; points have a walk of their own.
struct RayWalk {
  Traversal traversal = Traversal::automatic;
  Precision precision = Precision::float32;
};

class Committed {
 public:
  Committed(const PreparedScene& scene, query::GeometryTable table, const DeviceOptions& device);
  // All of the scene is geometry 0, as of a file. Throws ErrorCode::usage for a walk that there is not.
  Committed(const PreparedScene& scene, const DeviceOptions& device, const RayWalk& walk = {});
  Committed(const Committed&) = delete;
  Committed& operator=(const Committed&) = delete;

  const PreparedScene& scene() const { return scene_; }
  Picture render(const RenderOptions& options, Look look);
  query::QueryContext query_context() { return {places_, table_, frame_}; }

  // Of a query over so many rays or points that took this long, and of all that came before it.
  Statistics statistics(std::uint64_t n_asked, std::span<const double> seconds) const;
  double build_seconds() const { return devices_->build_seconds(); }  // compiling, until now
  bool has_compiled() const { return devices_->programs_used().compiled > 0; }

 private:
  void open_places(const RayWalk& walk);

  PreparedScene scene_;
  query::GeometryTable table_;
  query::LocalFrame frame_;
  std::shared_ptr<engine::DeviceScene> devices_;
  std::deque<query::Place> places_;
  std::mutex rendering_;
  std::optional<Renderer> renderer_;        // once a picture was asked for
  std::optional<PreparedScene> in_studio_;  // once one was asked for in a studio
};

}  // namespace kdray::api
