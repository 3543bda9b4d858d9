// What    kdray bench rays: the same rays through every traversal of kdray's, and through Embree.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/rays.json and a plot beside it.
// Errors  Hits that differ between kdray's traversals: exit code 1, after everything has been written.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "bench/cli/commands.h"
#include "bench/cli/limits.h"
#include "bench/cli/report_files.h"
#include "bench/race/kdray_contestants.h"
#include "bench/rays/bench.h"
#include "bench/workload/rays.h"

namespace kdray::cli {

namespace {

constexpr int kCoresMax = 4096;

struct RaysCommand {
  bench::RaysOptions options;
  std::string report;
};

int run(const RaysCommand& c) {
  require_scenes(c.options.scenes);
  prepare_report(c.report, "rays");
  if (c.options.embree) say_without_embree();
  const auto runs = bench::bench_rays(
      c.options, [](const bench::RaysRun& run) { print_table(bench::table_of(run)); },
      [](const std::string& what) { say(what); });
  write_report(c.report, "rays", bench::json_of(runs, c.options));
  if (const std::size_t n = bench::count_not_identical(runs); n > 0)
    throw Error(ErrorCode::internal,
                fmt::format("{} hits of kdray's traversals are not identical to the binary one's", n));
  return 0;
}

// "1,all": numbers of cores, 0 for all.
std::vector<int> parse_cores(const std::string& text) {
  std::vector<int> cores;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    const std::string item = text.substr(start, comma - start);
    cores.push_back(item == "all" ? 0 : parse_int("--cores", item, 1, kCoresMax));
    start = comma + 1;
  }
  return cores;
}

}  // namespace

Command add_bench_rays(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("rays", "The same rays through every traversal, and through Embree");
  const auto c = std::make_shared<RaysCommand>();
  bench::RaysOptions& o = c->options;
  add_scenes(*app, o.scenes, "boxes spheres balls rings");
  add_list(*app, "--classes", "Of rays (default: all)", bench::class_names(), o.classes);
  add_list(*app, "--traversals", "Ways through the tree (default: all)", bench::traversal_names(),
           o.traversals);
  add_int(*app, "--rays", "Rays of a class, as a square picture holds them (default 1048576)", 1, kRaysMax,
          o.rays);
  add_int(*app, "--repeat", "Rounds to take the median of (default 7)", 1, kRepeatMax, o.repeat);
  add_text(*app, "--cores", "LIST", "Numbers of cores, or all (default 1,all; on a GPU all)",
           [&o](const std::string& text) { o.cores = parse_cores(text); });
  app->add_flag_callback(
      "--no-embree", [&o] { o.embree = false; }, "Leave Embree out: kdray's traversals against each other");
  add_device_option(*app, "The device, as for render (default: auto)", o.device);
  add_report(*app, c->report);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
