// What    kdray trace: rays from a NumPy file, hits to a NumPy file.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/free_memory.h"
#include "base/timer.h"
#include "cli/command.h"
#include "cli/memory.h"
#include "cli/open_scene.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/run_files.h"
#include "cli/scene_input.h"
#include "cli/stats.h"
#include "cli/summary.h"
#include "kdray/kdray.h"
#include "rays/npy.h"
#include "scene/scene.h"

namespace kdray::cli {

namespace {

struct TraceArgs {
  SceneInput scene;
  std::string rays, output, stats;
  bool any_hit = false, quiet = false, verbose = false;
  int repeat = 1;
  Traversal traversal = Traversal::automatic;
  Precision precision = Precision::float32;
  CacheChoice cache;
  TreeOptions tree;
  DeviceOptions device;
};

void check_files(const TraceArgs& o, RunFiles& files) {
  check_scene_input(o.scene);
  files.read("SCENE", o.scene.file);
  files.read("--rays", o.rays);
  if (o.output == "-") check_stdout_takes_bytes("--output");
  files.write("--output", o.output);
  files.write("--stats", o.stats);
}

void write_hits(const std::string& output, std::span<const Hit> hits) {
  if (output != "-") return rays::write_hits(output, hits);
  print(rays::header_of_hits(hits.size()));
  print({reinterpret_cast<const char*>(hits.data()), hits.size_bytes()});
}

std::vector<Hit> trace(Renderer& renderer, const TraceArgs& o, std::span<const Ray> rays) {
  try {
    return renderer.trace(rays, o.any_hit, o.repeat, o.traversal, o.precision);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input) throw;
    throw input_error(o.rays, 0, error.what());  // the renderer doesn't know where the rays come from
  }
}

// The size of the file tells how many rays there are; whether it can be read is told by reading it.
void check_memory(const std::filesystem::path& rays) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(rays, error);
  if (!error) check_rays_fit(bytes / sizeof(Ray), free_memory());
}

int run(const TraceArgs& o) {
  const Timer total;
  RunFiles files;
  check_files(o, files);
  Timer step;
  check_memory(o.rays);
  const std::vector<Ray> rays = rays::read_rays(o.rays);
  const double read_rays = step.seconds();

  TreeOptions tree = o.tree;
  tree.binary_form = takes_binary_form(o.traversal, o.precision);
  OpenedScene scene(o.scene, tree, o.device, o.cache, o.quiet,
                    [&files](const scene::Scene& asked) { files.read_scene(asked.files); });
  Renderer renderer(scene.scene(), scene.device());
  const std::vector<Hit> hits = trace(renderer, o, rays);
  Statistics figures = renderer.statistics();
  step.restart();
  write_hits(o.output, hits);
  figures.seconds.write = step.seconds();
  scene.keep();
  scene.add_to(figures.seconds);
  figures.seconds.read_rays = read_rays;
  figures.seconds.total = total.seconds();

  Json stats = collect_stats("trace", o.scene.file, figures);
  stats["cache"] = scene.cache();
  const auto found = std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return std::isfinite(h.t); });
  stats["hits"] = {{"file", o.output},
                   {"rays", rays.size()},
                   {"hits", found},
                   {"any_hit", o.any_hit},
                   {"repeat", o.repeat}};
  if (!o.stats.empty()) write_stats(o.stats, stats);
  if (!o.quiet) print_trace_summary(stats, o.verbose);
  return 0;
}

}  // namespace

Command add_trace(CLI::App& kdray) {
  CLI::App* const app = kdray.add_subcommand("trace", "Trace rays from a NumPy file and write their hits");
  const auto o = std::make_shared<TraceArgs>();
  add_scene_input(*app, o->scene, "The scene, as for render");
  add_path(*app, "--rays", "The rays: float32, N x 8: origin, t_min, direction, t_max", o->rays)->required();
  add_path(*app, "-o,--output", "The hits: a structured array of t, primitive, u, v; '-': standard output",
           o->output)
      ->required();
  app->add_flag("--any-hit", o->any_hit, "Only whether something is hit, not what is hit first");
  add_int(*app, "--repeat", "Trace that often and report the median time (default 1)", 1, 1000000, o->repeat);
  add_path(*app, "--stats", "Write the run's figures as JSON ('-': to standard output)", o->stats);
  add_loudness(*app, o->quiet, o->verbose);
  add_device_options(*app, o->device, o->traversal, o->precision);
  add_cache_options(*app, o->cache);
  add_tree_options(*app, o->tree);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
