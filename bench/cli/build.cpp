// What    The commands that build trees. bench build: what they cost to build and what they gain, over
//         scenes, over sizes, over hostile meshes. bench depth: what trees of every maximum depth cost to
//         build, to hold and to trace.
#include "apps/cli/output.h"
#include "bench/build/bench.h"
#include "bench/cli/bench_command.h"
#include "scene/generate/hostile_meshes.h"

namespace kdray::cli {

namespace {

constexpr int kTrianglesMax = 100000000;

struct BuildCommand : BenchCommand<bench::BuildOptions> {
  bool hostile = false, growth = false;
  int triangles = 0;  // of a hostile mesh, or the most of the growing one; 0: the usual
  BuildQuality hostile_quality = BuildQuality::balanced;
};

int run_build(const BuildCommand& c) {
  require_scenes(c.options.scenes);
  const auto runs = run_bench("build", c.options, c.report, bench::bench_build);
  require_none(bench::count_not_identical(runs), "hits are not those over the balanced tree");
  return 0;
}

int run_growth(const BuildCommand& c) {
  if (!c.options.scenes.empty())
    throw Error(ErrorCode::usage, "--growth has a mesh of its own; leave the scenes out");
  bench::GrowthOptions options{.repeat = c.options.repeat, .embree = c.options.embree};
  if (c.triangles > 0)
    std::erase_if(options.sizes, [&](std::size_t n) { return n > static_cast<std::size_t>(c.triangles); });
  run_bench("growth", options, c.report, bench::bench_growth);
  return 0;
}

int run_hostile(const BuildCommand& c) {
  bench::HostileOptions options{
      .meshes = c.options.scenes, .repeat = c.options.repeat, .quality = c.hostile_quality};
  for (const std::string& name : options.meshes) parse_choice("--hostile", name, generate::hostile_names());
  if (c.triangles > 0) options.triangles = c.triangles;
  print_table(bench::hostile_heading());
  run_bench("hostile", options, c.report, bench::bench_hostile);
  return 0;
}

int run(const BuildCommand& c) {
  if (c.growth && c.hostile)
    throw Error(ErrorCode::usage, "--growth and --hostile are two benches: one at a time");
  if (c.growth) return run_growth(c);
  return c.hostile ? run_hostile(c) : run_build(c);
}

void add_build_options(CLI::App& app, BuildCommand& c) {
  bench::BuildOptions& o = c.options;
  add_scenes(app, o.scenes, "boxes spheres balls rings displaced");
  app.add_flag("--variants", o.variants,
               "The thesis' builders too: perfect, boxed, spatial median, object median");
  app.add_flag("--growth", c.growth, "Meshes of 10 thousand to 10 million triangles instead of scenes");
  app.add_flag("--hostile", c.hostile, "Meshes made to break a builder instead of scenes");
  add_build_option(app, c.hostile_quality)->description("Of --hostile (default: balanced)");
  add_int(app, "--triangles", "Of a hostile mesh (default 1000000); the most of a growing one", 1000,
          kTrianglesMax, c.triangles);
  add_rays(app, o.rays);
  add_no_embree(app, o.embree);
}

using DepthCommand = BenchCommand<bench::DepthOptions>;

int run_depth(const DepthCommand& c) {
  require_scenes(c.options.scenes);
  const auto runs = run_bench("depth", c.options, c.report, bench::bench_depth);
  require_none(bench::count_not_identical(runs), "hits are not those over the tree of usual depth");
  return 0;
}

void add_depth_options(CLI::App& app, DepthCommand& c) {
  add_scenes(app, c.options.scenes);
  add_build_option(app, c.options.quality);
  add_rays(app, c.options.rays);
}

}  // namespace

Command add_bench_build(CLI::App& bench) {
  return add_command(bench, "build", "Building trees: times, quality, memory, beside Embree's",
                     add_build_options, run);
}

Command add_bench_depth(CLI::App& bench) {
  return add_command(bench, "depth", "Trees by their maximum depth: build time, trace time, memory, cost",
                     add_depth_options, run_depth);
}

}  // namespace kdray::cli
