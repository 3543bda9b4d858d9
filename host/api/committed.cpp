#include "api/committed.h"

namespace kdray::api {

Committed::Committed(const PreparedScene& scene, query::GeometryTable table, const DeviceOptions& device)
    : scene_(scene),
      table_(std::move(table)),
      frame_(scene_.prepared().geometry),
      devices_(device, {}, scene_.prepared()),
      target_(target()),
      sessions_(target_),
      device_options_(device) {}

Picture Committed::render(const RenderOptions& options) {
  const std::lock_guard lock(rendering_);
  if (!renderer_) renderer_.emplace(scene_, device_options_);
  return renderer_->render(options);
}

query::Target Committed::target() {
  Device& first = devices_.first();
  query::Target target{first.context,     first.buffers(),  first.programs,
                       scene_.prepared(), first.work_group, first.global};
  target.space = LocalSpace();
  if (const std::vector<std::uint32_t> masks = table_.masks(); !masks.empty())
    target.masks = first.context.upload_copy(masks.data(), masks.size() * sizeof masks[0], "the masks");
  return target;
}

}  // namespace kdray::api
