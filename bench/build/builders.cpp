#include "bench/build/builders.h"

#include <fmt/format.h>

#include "accel/prepare/prepared.h"
#include "bench/workload/scenes.h"

namespace kdray::bench {

std::vector<Builder> quality_builders(std::size_t n_primitives) {
  std::vector<Builder> builders;
  for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best})
    builders.push_back({std::string(prepare::name_of(quality)),
                        prepare::config_of({.quality = quality, .binary_form = false}, n_primitives)});
  return builders;
}

std::vector<Builder> thesis_builders(std::size_t n_primitives) {
  kdtree::BuildConfig perfect =
      prepare::config_of({.quality = BuildQuality::best, .binary_form = false}, n_primitives);
  perfect.tight_cells = perfect.groups = false;
  kdtree::BuildConfig boxed = perfect, spatial = perfect, object = perfect;
  boxed.clip = false;
  spatial.split_rule = kdtree::SplitRule::spatial_median;
  object.split_rule = kdtree::SplitRule::object_median;
  return {{"perfect", perfect}, {"boxed", boxed}, {"spatial median", spatial}, {"object median", object}};
}

BuildInput::BuildInput(const std::string& name) : BuildInput(load_scene(name)) {
  if (geometry.size() == 0)
    throw Error(ErrorCode::input, name + ": nothing to build a tree of; the scene is empty");
}

TreeFacts facts_of(const prepare::Prepared& made) {
  return {.duplication = made.tree.duplication,
          .sah_cost = made.tree.sah_cost,
          .tight_cost = made.tree.tight_cost,
          .max_depth = made.tree.max_depth,
          .largest_leaf = made.tree.largest_leaf,
          .binary_bytes = made.flat.nodes.bytes() + made.flat.refs.bytes(),
          .wide_bytes = made.wide.bytes()};
}

Json json_of(const TreeFacts& t) {
  return {{"duplication", t.duplication}, {"sah_cost", t.sah_cost},         {"tight_cost", t.tight_cost},
          {"max_depth", t.max_depth},     {"binary_bytes", t.binary_bytes}, {"wide_bytes", t.wide_bytes}};
}

Json json_of(const BuildSpreads& s) {
  return {{"tree", json_of(s.tree)},
          {"flatten", json_of(s.flatten)},
          {"total", json_of(s.total)},
          {"cpu", json_of(s.cpu)}};
}

std::string times_heading() {
  return fmt::format("{:>9}{:>9}{:>9} {:^19}{:>9}", "tree", "flatten", "both", "min-max", "cpu");
}

std::string times_cells(const BuildSpreads& s) {
  return fmt::format("{:>9.1f}{:>9.1f}{:>9.1f} {:>9.1f}-{:<9.1f}{:>9.1f}", 1e3 * s.tree.median,
                     1e3 * s.flatten.median, 1e3 * s.total.median, 1e3 * s.total.min, 1e3 * s.total.max,
                     1e3 * s.cpu.median);
}

}  // namespace kdray::bench
