#include "api/committed.h"

#include "api/record.h"
#include "base/median.h"

namespace kdray::api {

namespace {

query::GeometryTable table_of_one(const prepare::Prepared& scene) {
  query::GeometryTable table;
  table.add(0, static_cast<std::uint32_t>(scene.counts.primitives), 0xffffffffu);
  if (const std::size_t n = scene.counts.instances; n > 0)
    table.add_instances(0, scene.flat.instances[n - 1].number + 1, 0xffffffffu);
  return table;
}

}  // namespace

Committed::Committed(const PreparedScene& scene, query::GeometryTable table, const DeviceOptions& device)
    : scene_(scene),
      table_(std::move(table)),
      frame_(scene_.prepared().geometry),
      devices_(device, {}, scene_.prepared()),
      target_(target()),
      sessions_(target_),
      device_options_(device) {}

Committed::Committed(const PreparedScene& scene, const DeviceOptions& device)
    : Committed(scene, table_of_one(scene.prepared()), device) {}

Statistics Committed::statistics(std::uint64_t n_asked, std::span<const double> seconds) const {
  Statistics statistics = first_statistics(scene_.prepared(), devices_);
  record_query(
      statistics, devices_,
      {.rays = n_asked, .repeat = seconds.size(), .seconds = median({seconds.begin(), seconds.end()})});
  return statistics;
}

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
  std::vector<std::uint32_t> instances;
  for (const layout::Instance& instance : scene_.prepared().flat.instances)
    instances.push_back(instance.number);
  if (const std::vector<std::uint32_t> masks = table_.masks(instances); !masks.empty())
    target.masks = first.context.upload_copy(masks.data(), masks.size() * sizeof masks[0], "the masks");
  return target;
}

}  // namespace kdray::api
