// What    The commands that hold kdray against Embree. bench rays: the same rays through every traversal of
//         kdray's, and through Embree. bench instances: the same rays among instances of a mesh and among
//         copies of it. bench queries: the same questions to both, from arrays to arrays, in batches of
//         several sizes.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/output.h"
#include "bench/cli/bench_command.h"
#include "bench/instances/bench.h"
#include "bench/queries/bench.h"
#include "bench/race/race.h"
#include "bench/rays/bench.h"
#include "bench/workload/scenes.h"

namespace kdray::cli {

namespace {

using RaysCommand = BenchCommand<bench::RaysOptions>;
using InstancesCommand = BenchCommand<bench::InstancesOptions>;
using QueriesCommand = BenchCommand<bench::QueriesOptions>;

// ---- bench rays

int run_rays(const RaysCommand& c) {
  if (const auto missing = bench::data_scenes().missing; c.options.scenes.empty() && !missing.empty())
    say(fmt::format("left out, since KDRAY_DATA names no folder that has them: {}", fmt::join(missing, " ")));
  require_scenes(c.options.scenes);
  const auto runs = run_bench("rays", c.options, c.report, bench::bench_rays);
  require_none(bench::count_not_identical(runs),
               "hits of kdray's traversals are not identical to the binary one's");
  return 0;
}

// "all" is 0.
int parse_cores(const std::string& option, const std::string& text) {
  return text == "all" ? 0 : parse_int(option, text, 1, kCoresMax);
}

void add_rays_options(CLI::App& app, RaysCommand& c) {
  bench::RaysOptions& o = c.options;
  add_scenes(app, o.scenes, fmt::format("{}", fmt::join(bench::default_scenes(), " ")));
  add_list(app, "--classes", "Of rays (default: all)", bench::class_names(), o.classes);
  add_list(app, "--traversals", "Ways through the tree (default: all)", bench::traversal_names(),
           o.traversals);
  add_rays(app, o.rays);
  add_values(app, "--cores", "Numbers of cores, or all (default 1,all; on a GPU all)", o.cores, parse_cores);
  add_no_embree(app, o.embree);
}

// ---- bench instances

int run_instances(const InstancesCommand& c) {
  require_scenes(c.options.meshes);
  const auto runs = run_bench("instances", c.options, c.report, bench::bench_instances);
  require_none(bench::count_not_identical(runs), "hits of kdray's traversals are not identical");
  return 0;
}

void add_instances_options(CLI::App& app, InstancesCommand& c) {
  constexpr int kAcrossMax = 1000;
  bench::InstancesOptions& o = c.options;
  add_scenes(app, o.meshes, "a ball of 75,000 triangles");
  add_values(app, "--apart", "From middle to middle, in sizes of the mesh (default 1,0.5,0.25)", o.apart,
             [](const auto& option, const auto& text) { return parse_real(option, text, 1e-3, 1e3); });
  add_int(app, "--across", "Instances in a row, and rows (default 5)", 1, kAcrossMax, o.across);
  static const std::vector<std::string_view> kTraversals = bench::instance_traversals();
  add_list(app, "--classes", "Of rays (default: primary,shadow,diffuse,random)", bench::class_names(),
           o.classes);
  add_list(app, "--traversals", "Ways through the tree (default: all)", kTraversals, o.traversals);
  add_rays(app, o.rays);
  add_int(app, "--cores", "Number of cores (default: all)", 1, kCoresMax, o.cores);
  add_no_embree(app, o.embree);
}

// ---- bench queries

int run_queries(const QueriesCommand& c) {
  require_scenes(c.options.scenes);
  run_bench("queries", c.options, c.report, bench::bench_queries);
  return 0;
}

void add_queries_options(CLI::App& app, QueriesCommand& c) {
  bench::QueriesOptions& o = c.options;
  add_scenes(app, o.scenes);
  add_list(app, "--queries", "Questions (default: all)", bench::question_names(), o.questions);
  add_list(app, "--sets", "Sets of rays (default: all)", bench::set_names(), o.sets);
  add_values(app, "--batches", "Rays or points to a call (default 1,100,10000,1000000)", o.batches,
             [](const auto& option, const auto& text) { return parse_int(option, text, 1, kRaysMax); });
  add_int(app, "--rays", "Rays or points of a set (default 1000000)", 1, kRaysMax, o.rays);
  add_no_embree(app, o.embree);
  add_geometry_option(app, o.geometry);
}

}  // namespace

Command add_bench_rays(CLI::App& bench) {
  return add_command(bench, "rays", "The same rays through every traversal, and through Embree",
                     add_rays_options, run_rays);
}

Command add_bench_instances(CLI::App& bench) {
  return add_command(bench, "instances", "The same rays among instances of a mesh and among copies of it",
                     add_instances_options, run_instances);
}

Command add_bench_queries(CLI::App& bench) {
  return add_command(bench, "queries", "The same questions from arrays, to kdray and to Embree",
                     add_queries_options, run_queries);
}

}  // namespace kdray::cli
