// What    kdray trace: rays from a NumPy file, hits to a NumPy file.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/timer.h"
#include "base/write_file.h"
#include "cli/command.h"
#include "cli/open_scene.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/stats.h"
#include "cli/summary.h"
#include "kdray/kdray.h"
#include "rays/npy.h"

namespace kdray::cli {

namespace {

struct TraceArgs {
  std::string scene, rays, output, stats;
  bool any_hit = false, quiet = false;
  int repeat = 1;
  Traversal traversal = Traversal::automatic;
  Precision precision = Precision::float32;
  CacheChoice cache;
  TreeOptions tree;
  DeviceOptions device;
};

void check_files(const TraceArgs& o) {
  check_writable(o.output);
  if (!o.stats.empty()) check_text_output(o.stats);
  check_apart("SCENE", o.scene, "--output", o.output);
  check_apart("SCENE", o.scene, "--stats", o.stats);
  check_apart("--rays", o.rays, "--output", o.output);
  check_apart("--rays", o.rays, "--stats", o.stats);
  check_apart("--output", o.output, "--stats", o.stats);
}

int run(const TraceArgs& o) {
  const Timer total;
  check_files(o);
  Timer step;
  const std::vector<Ray> rays = rays::read_rays(o.rays);
  const double read_rays = step.seconds();

  TreeOptions tree = o.tree;
  tree.binary_form = takes_binary_form(o.traversal, o.precision);
  OpenedScene scene(o.scene, tree, o.device, o.cache, o.quiet);
  Renderer renderer(scene.scene(), scene.device());
  const std::vector<Hit> hits = renderer.trace(rays, o.any_hit, o.repeat, o.traversal, o.precision);
  OwnSeconds seconds;
  step.restart();
  rays::write_hits(o.output, hits);
  seconds.write = step.seconds();
  scene.keep();
  seconds.cache = scene.cache_seconds();
  seconds.load = scene.load_seconds();
  seconds.total = total.seconds();

  Json stats = collect_stats("trace", o.scene, renderer.statistics(), seconds);
  stats["cache"] = scene.cache();
  stats["seconds"]["read_rays"] = read_rays;
  const auto found = std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return std::isfinite(h.t); });
  stats["hits"] = {{"file", o.output},
                   {"rays", rays.size()},
                   {"hits", found},
                   {"any_hit", o.any_hit},
                   {"repeat", o.repeat}};
  if (!o.stats.empty()) write_stats(o.stats, stats);
  if (!o.quiet) print_trace_summary(stats, o.output, rays.size(), static_cast<std::size_t>(found));
  return 0;
}

}  // namespace

Command add_trace(CLI::App& kdray) {
  CLI::App* const app = kdray.add_subcommand("trace", "Trace rays from a NumPy file and write their hits");
  const auto o = std::make_shared<TraceArgs>();
  app->add_option("SCENE", o->scene, "The scene, as for render")->required()->type_name("");
  add_path(*app, "--rays", "The rays: float32, N x 8: origin, t_min, direction, t_max", o->rays)->required();
  add_path(*app, "-o,--output", "The hits: a structured array of t, primitive, u, v", o->output)->required();
  app->add_flag("--any-hit", o->any_hit, "Only whether something is hit, not what is hit first");
  add_int(*app, "--repeat", "Trace that often and report the median time (default 1)", 1, 1000000, o->repeat);
  add_path(*app, "--stats", "Write the run's figures as JSON ('-': to standard output)", o->stats);
  app->add_flag("-q,--quiet", o->quiet, "Say nothing unless something is wrong");
  add_device_options(*app, o->device, o->traversal, o->precision);
  add_cache_options(*app, o->cache);
  add_tree_options(*app, o->tree);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
