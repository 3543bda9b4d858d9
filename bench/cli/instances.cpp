// What    kdray bench instances: the same rays among instances of a mesh and among copies of it.
// Shape   Tables go to stderr, each as soon as it is done; with --report DIR the figures go to
//         DIR/instances.json and a plot beside it.
// Errors  Hits that differ between kdray's traversals of one form: exit code 1, after everything has been
//         written.
#include "bench/instances/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "bench/cli/commands.h"
#include "bench/cli/limits.h"
#include "bench/cli/report_files.h"
#include "bench/workload/rays.h"

namespace kdray::cli {

namespace {

constexpr int kAcrossMax = 1000;
constexpr double kApartMin = 1e-3, kApartMax = 1e3;

struct InstancesCommand {
  bench::InstancesOptions options;
  std::string report;
};

int run(const InstancesCommand& c) {
  require_scenes(c.options.meshes);
  prepare_report(c.report, "instances");
  if (c.options.embree) say_without_embree();
  const auto runs = bench::bench_instances(
      c.options, [](const bench::InstancesRun& run) { print_table(bench::table_of(run)); },
      [](const std::string& what) { say(what); });
  write_report(c.report, "instances", bench::json_of(runs, c.options));
  if (const std::size_t n = bench::count_not_identical(runs); n > 0)
    throw Error(ErrorCode::internal, fmt::format("{} hits of kdray's traversals are not identical", n));
  return 0;
}

// "1,0.5"
std::vector<double> parse_apart(const std::string& text) {
  std::vector<double> apart;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    apart.push_back(parse_real("--apart", text.substr(start, comma - start), kApartMin, kApartMax));
    start = comma + 1;
  }
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
  add_int(*app, "--rays", "Rays of a class, as a square picture holds them (default 1048576)", 1, kRaysMax,
          o.rays);
  add_int(*app, "--repeat", "Rounds to take the median of (default 7)", 1, kRepeatMax, o.repeat);
  add_int(*app, "--cores", "Number of cores (default: all)", 1, 4096, o.cores);
  app->add_flag_callback(
      "--no-embree", [&o] { o.embree = false; }, "Leave Embree out: kdray's traversals against each other");
  add_device_option(*app, "The device, as for render (default: auto)", o.device);
  add_report(*app, c->report);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
