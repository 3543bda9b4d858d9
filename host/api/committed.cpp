#include "api/committed.h"

namespace kdray::api {

Committed::Committed(const PreparedScene& scene, query::GeometryTable table, const DeviceOptions& device)
    : scene_(scene),
      table_(std::move(table)),
      frame_(scene_.prepared().geometry),
      devices_(device, {}, scene_.prepared()),
      sessions_(target(), table_.masks()),
      device_options_(device) {}

Picture Committed::render(const RenderOptions& options) {
  const std::lock_guard lock(rendering_);
  if (!renderer_) renderer_.emplace(scene_, device_options_);
  return renderer_->render(options);
}

query::Target Committed::target() {
  Device& first = devices_.first();
  return {first.context, first.buffers(), first.programs, scene_.prepared(), first.work_group, first.global};
}

}  // namespace kdray::api
