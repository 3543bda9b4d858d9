#include "statistics.h"

#include "flatten/features.h"
#include "prepare/quality.h"

namespace kdray::api {

Json scene_json(const prepare::Prepared& scene) {
  return {{"primitives", scene.counts.primitives},
          {"triangles", scene.counts.triangles},
          {"spheres", scene.counts.spheres},
          {"cones", scene.counts.cones},
          {"lights", scene.settings.lights.size()},
          {"materials", scene.settings.materials.size()},
          {"dropped_degenerate", scene.geometry.dropped_degenerate}};
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
          {"vectors", info.vectors}};
}

Json features_json(std::uint32_t mask) {
  const flatten::FeatureNames names = flatten::feature_names(mask);
  return {{"on", names.on}, {"off", names.off}};
}

Json rays_json(const wavefront::Counters& c) {
  return {{"primary", c.primary},
          {"primary_hit", c.primary_hit},
          {"shadow", c.shadow},
          {"reflected", c.reflected},
          {"refracted", c.refracted},
          {"total", c.total()},
          {"skipped",
           {{"light_behind", c.skipped_behind},
            {"light_of_no_weight", c.skipped_unlit},
            {"below_min_weight", c.skipped_weight},
            {"too_deep", c.skipped_depth}}}};
}

}  // namespace kdray::api
