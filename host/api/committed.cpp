#include "api/committed.h"

#include "api/hooks.h"
#include "api/open_devices.h"
#include "api/precision.h"
#include "api/record.h"
#include "base/timer.h"
#include "engine/query/scene_arguments.h"

namespace kdray::api {

namespace {

scene::Copies copies_of(const prepare::Prepared& scene) {
  return scene.doubles ? scene.doubles->copies : scene::Copies();
}

// Whether devices are to look first at what is asked of a scene of doubles: they leave the host all rays that
// come near shapes, and widen boxes by 11u of the scene's size more than what lies in them needs.
bool suits_filter(const prepare::Prepared& scene) {
  const scene::DoubleGeometry* doubles = scene.doubles.get();
  return doubles != nullptr && doubles->corners.size() > doubles->n_shapes() &&
         doubles->apart <= 0x1p-21 * query::world_max(scene.geometry.bounds);
}

query::LocalFrame frame_of(const prepare::Prepared& scene) {
  return query::LocalFrame(scene.geometry, scene.doubles ? scene.doubles->apart : 0);
}

query::GeometryTable table_of_one(const prepare::Prepared& scene) {
  query::GeometryTable table;
  if (const scene::Copies copies = copies_of(scene); copies.size() > 0) {
    table.add(0, copies.first.front(), 0xffffffffu);
    table.add_instances(0, static_cast<std::uint32_t>(copies.size()), 0xffffffffu);
    return table;
  }
  table.add(0, static_cast<std::uint32_t>(scene.counts.primitives), 0xffffffffu);
  if (const std::size_t n = scene.counts.instances; n > 0)
    table.add_instances(0, scene.flat.instances[n - 1].number + 1, 0xffffffffu);
  return table;
}

}  // namespace

Committed::Committed(const PreparedScene& scene, query::GeometryTable table, const DeviceOptions& device)
    : scene_(scene),
      table_(std::move(table)),
      frame_(frame_of(scene_.prepared())),
      devices_(open_scene(scene_.prepared(), device)) {
  open_places({});
}

Committed::Committed(const PreparedScene& scene, const DeviceOptions& device, const RayWalk& walk)
    : scene_(scene),
      table_(table_of_one(scene_.prepared())),
      frame_(frame_of(scene_.prepared())),
      devices_(open_scene(scene_.prepared(), device)) {
  open_places(walk);
}

void Committed::open_places(const RayWalk& walk) {
  table_.set_copies(copies_of(scene_.prepared()));
  const Traversal traversal = traversal_of_rays(walk.precision, walk.traversal, *devices_);
  std::vector<std::uint32_t> instances;
  for (const layout::Instance& instance : scene_.prepared().flat.instances)
    instances.push_back(instance.number);
  const std::vector<std::uint32_t> masks = table_.masks(instances);
  for (query::Target& target : query::targets_of(*devices_, traversal, walk.precision)) {
    target.space = LocalSpace();
    target.filters = target.context.rounds_division_correctly() && suits_filter(scene_.prepared());
    if (!masks.empty())
      target.masks = target.sub_device > 0 ? places_.back().target.masks
                                           : target.context.upload_copy(
                                                 masks.data(), masks.size() * sizeof masks[0], "the masks");
    places_.emplace_back(target);
  }
}

Statistics Committed::statistics(std::uint64_t n_asked, std::span<const double> seconds) const {
  Statistics statistics = first_statistics(*devices_);
  const query::Target& first = places_.front().target;
  record_query(statistics, *devices_,
               {.rays = n_asked,
                .repeat = seconds.size(),
                .seconds = median({seconds.begin(), seconds.end()}),
                .traversal = first.walk(),
                .precision = first.precision});
  return statistics;
}

namespace {

// Returns what lights that follow the camera have to know of it.
View view_of(const std::optional<Camera>& camera) {
  if (!camera) return {};
  View view{.from = camera->from, .at = camera->at, .up = camera->up};
  if (camera->ortho_width > 0)
    view.ortho_width = camera->ortho_width;
  else
    view.fov = camera->fov;
  return view;
}

}  // namespace

Picture Committed::render(const RenderOptions& options, Look look) {
  const std::lock_guard lock(rendering_);
  if (!renderer_) renderer_.emplace(make_renderer(devices_));
  if (look == Look::studio) {
    if (!in_studio_) in_studio_ = scene_.in_studio();
    renderer_->look(in_studio_->seen(view_of(options.camera), options.width, options.height));
  } else if (in_studio_) {
    renderer_->look(scene_);
  }
  return renderer_->render(options);
}

}  // namespace kdray::api
