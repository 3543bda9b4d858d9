#include "statistics.h"

#include <algorithm>

#include "flatten/features.h"
#include "prepare/quality.h"

namespace kdray::api {

Json scene_json(const prepare::Prepared& scene) {
  Json json = {{"primitives", scene.counts.primitives},
               {"lights", scene.settings.lights.size()},
               {"materials", scene.settings.materials.size()},
               {"dropped_degenerate", scene.geometry.dropped_degenerate}};
  primitives::for_each_kind([&](auto kind) { json[kind.kNames] = decltype(kind)::of(scene.counts); });
  return json;
}

Json tree_json(const prepare::Prepared& scene) {
  const kdtree::Statistics& s = scene.tree;
  return {{"build", prepare::name_of(scene.tree_options.quality)},
          {"nodes", scene.tree_nodes},
          {"inner_nodes", s.inner_nodes},
          {"leaves", s.leaves},
          {"empty_leaves", s.empty_leaves},
          {"references", s.references},
          {"duplication", s.duplication},
          {"largest_leaf", s.largest_leaf},
          {"max_depth", s.max_depth},
          {"mean_leaf_depth", s.mean_leaf_depth},
          {"sah_cost", s.sah_cost}};
}

Json device_json(const DeviceInfo& info) {
  return {{"number", info.number},
          {"name", info.name},
          {"platform", info.platform},
          {"version", info.version},
          {"driver", info.driver},
          {"kind", info.kind},
          {"compute_units", info.compute_units},
          {"global_memory", info.global_memory},
          {"max_allocation", info.max_allocation},
          {"vectors", info.vectors},
          {"double_precision", info.double_precision}};
}

Json features_json(layout::Features mask) {
  const flatten::FeatureNames names = flatten::feature_names(mask);
  return {{"on", names.on}, {"off", names.off}};
}

Json rays_json(const wavefront::Counters& counters) {
#define KDRAY_KEY(name, field, key) {key, counters.name},
  Json rays = {KDRAY_COUNTERS_OF_TRACED(KDRAY_KEY)};
  rays["total"] = counters.total();
  rays["skipped"] = {KDRAY_COUNTERS_OF_SKIPPED(KDRAY_KEY)};
#undef KDRAY_KEY
  return rays;
}

Json samples_json(const layout::Frame& frame, const adaptive::Report* adaptive) {
  const auto pixels = static_cast<double>(std::size_t{frame.width} * frame.height);
  if (!adaptive)
    return {{"mode", "uniform"},
            {"total", std::uint64_t{frame.width} * frame.height * frame.n_samples},
            {"per_pixel", frame.n_samples}};
  Json by_count = Json::object();
  for (int level = 0; level < adaptive::kLevels; ++level)
    by_count[std::to_string(adaptive::samples_of(level))] = adaptive->pixels[static_cast<std::size_t>(level)];
  return {{"mode", "adaptive"},
          {"total", adaptive->samples},
          {"per_pixel", static_cast<double>(adaptive->samples) / pixels},
          {"rounds", adaptive->rounds},
          {"target", adaptive->target},
          {"estimated_rmse", adaptive->estimated_rmse},
          {"stopped", adaptive->met ? "target" : "cap"},
          {"pixels", std::move(by_count)}};
}

namespace {

Json queue_json(std::size_t number, const pdprt::QueueResult& queue, double seconds) {
  const double idle = seconds > 0 ? std::clamp(1 - queue.busy_seconds / seconds, 0.0, 1.0) : 0.0;
  return {{"queue", number},    {"device", queue.device}, {"busy_seconds", queue.busy_seconds},
          {"idle_share", idle}, {"rays", queue.rays},     {"tiles", queue.tiles}};
}

}  // namespace

Json pdprt_json(const pdprt::Result& result) {
  Json mode = {{"name", "pdprt"},
               {"queues", result.queues.size()},
               {"tile", {result.tile_width, result.tile_height}},
               {"tiles", result.n_tiles},
               {"bands", result.n_bands},
               {"launches", result.counters.launches},
               {"waves", result.counters.waves},
               {"quarantined", Json::array()},
               {"per_queue", Json::array()}};
  for (std::size_t i = 0; i < result.queues.size(); ++i) {
    const pdprt::QueueResult& queue = result.queues[i];
    mode["per_queue"].push_back(queue_json(i, queue, result.render_seconds));
    if (!queue.failure.empty()) mode["quarantined"].push_back({{"queue", i}, {"what", queue.failure}});
  }
  if (!result.tile_seconds.empty()) mode["tile_seconds"] = result.tile_seconds;
  return mode;
}

Json pdprt_memory_json(const pdprt::Result& result, std::size_t scene_bytes) {
  std::size_t frame_bytes = 0;
  Json per_queue = Json::array();
  for (const pdprt::QueueResult& queue : result.queues) {
    frame_bytes += queue.device_bytes;
    per_queue.push_back({{"geometry_bytes", scene_bytes}, {"work_bytes", queue.device_bytes}});
  }
  return {{"frame_bytes", frame_bytes}, {"per_queue", std::move(per_queue)}};
}

}  // namespace kdray::api
