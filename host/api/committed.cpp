#include "api/committed.h"

namespace kdray::api {

Committed::Committed(const PreparedScene& scene, query::GeometryTable table, const DeviceOptions& device)
    : scene_(scene),
      table_(std::move(table)),
      frame_(scene_.prepared().geometry),
      devices_(device, {}, scene_.prepared()),
      sessions_(target(), table_.masks()) {}

query::Target Committed::target() {
  Device& first = devices_.first();
  return {first.context, first.buffers(), first.programs, scene_.prepared(), first.work_group, first.global};
}

}  // namespace kdray::api
