// What    kdray bench instances: the same rays among instances of a mesh and among copies of it.
// Shape   Tables go to stderr, each as soon as it is done; with --report DIR the figures go to
//         DIR/instances.json and a plot beside it.
// Errors  Hits that differ between kdray's traversals of one form: exit code 1, after everything has been
//         written.
#include "base/text.h"
#include "bench/instances/bench.h"

#include <memory>
#include <string>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "bench/cli/bench_command.h"
#include "bench/cli/commands.h"
#include "bench/workload/rays.h"

namespace kdray::cli {

namespace {

constexpr int kAcrossMax = 1000;
constexpr double kApartMin = 1e-3, kApartMax = 1e3;

using InstancesCommand = BenchCommand<bench::InstancesOptions>;

int run(const InstancesCommand& c) {
  require_scenes(c.options.meshes);
  const auto runs = run_bench("instances", c.options, c.report, bench::bench_instances);
  require_none(bench::count_not_identical(runs), "hits of kdray's traversals are not identical");
  return 0;
}

// "1,0.5"
std::vector<double> parse_apart(const std::string& text) {
  std::vector<double> apart;
  for (const std::string& item : split_list(text))
    apart.push_back(parse_real("--apart", item, kApartMin, kApartMax));
  return apart;
}

}  // namespace

Command add_bench_instances(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("instances", "The same rays among instances of a mesh and among copies of it");
  const auto c = std::make_shared<InstancesCommand>();
  bench::InstancesOptions& o = c->options;
  add_scenes(*app, o.meshes, "a ball of 75,000 triangles");
  add_text(*app, "--apart", "LIST", "From middle to middle, in sizes of the mesh (default 1,0.5,0.25)",
           [&o](const std::string& text) { o.apart = parse_apart(text); });
  add_int(*app, "--across", "Instances in a row, and rows (default 5)", 1, kAcrossMax, o.across);
  static const std::vector<std::string_view> kTraversals = bench::instance_traversals();
  add_list(*app, "--classes", "Of rays (default: primary,shadow,diffuse,random)", bench::class_names(),
           o.classes);
  add_list(*app, "--traversals", "Ways through the tree (default: all)", kTraversals, o.traversals);
  add_rays(*app, o.rays);
  add_int(*app, "--cores", "Number of cores (default: all)", 1, 4096, o.cores);
  add_no_embree(*app, o.embree);
  add_usual(*app, *c);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
