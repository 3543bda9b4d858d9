// What    kdray bench build: what trees cost to build and what they gain, over scenes, over sizes, over
//         hostile meshes.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/build.json (or growth, hostile) and a plot beside it.
#include <fmt/format.h>

#include <memory>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "bench/build/report.h"
#include "bench/cli/commands.h"
#include "bench/cli/limits.h"
#include "bench/cli/report_files.h"
#include "scene/generate/hostile_meshes.h"

namespace kdray::cli {

namespace {

constexpr int kTrianglesMax = 100000000;

struct BuildCommand {
  bench::BuildOptions options;
  bool hostile = false, growth = false;
  int triangles = 0;  // of a hostile mesh, or the most of the growing one; 0: the usual
  BuildQuality hostile_quality = BuildQuality::balanced;
  std::string report;
};

void tell(const std::string& what) {
  say(what);
}

int run_build(const BuildCommand& c) {
  require_scenes(c.options.scenes);
  prepare_report(c.report, "build");
  if (c.options.embree) say_without_embree();
  const auto runs = bench::bench_build(
      c.options, [](const bench::BuildRun& run) { print_table(bench::table_of(run)); }, tell);
  write_report(c.report, "build", bench::json_of(runs, c.options));
  if (const std::size_t n = bench::count_not_identical(runs); n > 0)
    throw Error(ErrorCode::internal, fmt::format("{} hits are not those over the balanced tree", n));
  return 0;
}

int run_growth(const BuildCommand& c) {
  if (!c.options.scenes.empty())
    throw Error(ErrorCode::usage, "--growth has a mesh of its own; leave the scenes out");
  bench::GrowthOptions options{.repeat = c.options.repeat, .embree = c.options.embree};
  if (c.triangles > 0)
    std::erase_if(options.sizes, [&](std::size_t n) { return n > static_cast<std::size_t>(c.triangles); });
  prepare_report(c.report, "growth");
  if (options.embree) say_without_embree();
  const auto results = bench::bench_growth(
      options, [](const bench::GrowthResult& r) { print_table(bench::table_of(r)); }, tell);
  write_report(c.report, "growth", bench::json_of(results, options));
  return 0;
}

int run_hostile(const BuildCommand& c) {
  bench::HostileOptions options{
      .meshes = c.options.scenes, .repeat = c.options.repeat, .quality = c.hostile_quality};
  for (const std::string& name : options.meshes) parse_choice("--hostile", name, generate::hostile_names());
  if (c.triangles > 0) options.triangles = c.triangles;
  prepare_report(c.report, "hostile");
  print_table(bench::hostile_heading());
  const auto results = bench::bench_hostile(
      options, [](const bench::HostileResult& r) { print_table(bench::table_of(r)); }, tell);
  write_report(c.report, "hostile", bench::json_of(results, options));
  return 0;
}

int run(const BuildCommand& c) {
  if (c.growth && c.hostile)
    throw Error(ErrorCode::usage, "--growth and --hostile are two benches: one at a time");
  if (c.growth) return run_growth(c);
  return c.hostile ? run_hostile(c) : run_build(c);
}

}  // namespace

Command add_bench_build(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("build", "Building trees: times, quality, memory, beside Embree's");
  const auto c = std::make_shared<BuildCommand>();
  bench::BuildOptions& o = c->options;
  add_scenes(*app, o.scenes, "boxes spheres balls rings displaced");
  app->add_flag("--variants", o.variants,
                "The thesis' builders too: perfect, boxed, spatial median, object median");
  app->add_flag("--growth", c->growth, "Meshes of 10 thousand to 10 million triangles instead of scenes");
  app->add_flag("--hostile", c->hostile, "Meshes made to break a builder instead of scenes");
  add_build_option(*app, c->hostile_quality)->description("Of --hostile (default: balanced)");
  add_int(*app, "--triangles", "Of a hostile mesh (default 1000000); the most of a growing one", 1000,
          kTrianglesMax, c->triangles);
  add_int(*app, "--rays", "Rays of a class, as a square picture holds them (default 262144)", 1, kRaysMax,
          o.rays);
  add_int(*app, "--repeat", "Rounds to take the median of (default 5)", 1, kRepeatMax, o.repeat);
  app->add_flag_callback(
      "--no-embree", [&o] { o.embree = false; }, "Leave Embree out");
  add_device_option(*app, "The device, as for render (default: auto)", o.device);
  add_report(*app, c->report);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
