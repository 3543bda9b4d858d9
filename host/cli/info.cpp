// What    kdray info: what a scene holds, the tree kdray builds for it, the memory both take. Needs no
//         device.
// Units   world units; bytes as held by this process; the tree's cost in units of its own constants.
#include <memory>
#include <string>

#include "base/timer.h"
#include "cli/command.h"
#include "cli/info_report.h"
#include "cli/message.h"
#include "cli/options.h"
#include "cli/output.h"
#include "kdtree/build.h"
#include "kdtree/statistics.h"
#include "scene/geometry.h"
#include "scene/load.h"

namespace kdray::cli {

namespace {

struct Options {
  std::string scene;
  TreeOptions tree;
  bool json = false;
};

int run(const Options& o) {
  Timer step;
  const scene::Scene scene = scene::load(o.scene);
  const double load_seconds = step.seconds();
  for (const std::string& warning : scene.warnings) say(warning);

  step.restart();
  const scene::Geometry geometry = scene::make_geometry(scene);
  const kdtree::BuildConfig config = kdtree::suited({.cost_traverse = o.tree.cost_traverse,
                                                     .cost_intersect = o.tree.cost_intersect,
                                                     .empty_bonus = o.tree.empty_bonus,
                                                     .max_depth = o.tree.max_depth},
                                                    geometry.size());
  const kdtree::Tree tree = kdtree::build(geometry, config);
  const double build_seconds = step.seconds();

  Json report = scene_report(scene, geometry);
  report["tree"] = tree_report(tree, kdtree::measure(tree, geometry, config));
  report["memory"] = memory_report(scene, geometry, tree);
  report["seconds"] = {{"load", load_seconds}, {"build", build_seconds}};
  print(o.json ? report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n" : report_as_text(report));
  return 0;
}

}  // namespace

Command add_info(CLI::App& kdray) {
  CLI::App* const app =
      kdray.add_subcommand("info", "Show counts, bounds, materials, tree statistics and memory of a scene");
  const auto o = std::make_shared<Options>();
  app->add_option("SCENE", o->scene, "The scene, as for render")->required()->type_name("");
  app->add_flag("--json", o->json, "Print JSON");
  add_tree_options(*app, o->tree);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
