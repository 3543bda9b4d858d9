// What    kdray bench depth: what trees of every maximum depth cost to build, to hold and to trace.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/depth.json and a plot beside it.
#include <fmt/format.h>

#include <memory>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "bench/build/report.h"
#include "bench/cli/commands.h"
#include "bench/cli/limits.h"
#include "bench/cli/report_files.h"

namespace kdray::cli {

namespace {

struct DepthCommand {
  bench::DepthOptions options;
  std::string report;
};

int run(const DepthCommand& c) {
  require_scenes(c.options.scenes);
  prepare_report(c.report, "depth");
  const auto runs = bench::bench_depth(
      c.options, [](const bench::DepthRun& run) { print_table(bench::table_of(run)); },
      [](const std::string& what) { say(what); });
  write_report(c.report, "depth", bench::json_of(runs, c.options));
  if (const std::size_t n = bench::count_not_identical(runs); n > 0)
    throw Error(ErrorCode::internal, fmt::format("{} hits are not those over the tree of usual depth", n));
  return 0;
}

}  // namespace

Command add_bench_depth(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("depth", "Trees by their maximum depth: build time, trace time, memory, cost");
  const auto c = std::make_shared<DepthCommand>();
  bench::DepthOptions& o = c->options;
  add_scenes(*app, o.scenes, "boxes balls rings displaced");
  add_build_option(*app, o.quality);
  add_int(*app, "--rays", "Rays of a class, as a square picture holds them (default 65536)", 1, kRaysMax,
          o.rays);
  add_int(*app, "--repeat", "Rounds to take the median of (default 3)", 1, kRepeatMax, o.repeat);
  add_device_option(*app, "The device, as for render (default: auto)", o.device);
  add_report(*app, c->report);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
