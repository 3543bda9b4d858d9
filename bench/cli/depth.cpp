// What    kdray bench depth: what trees of every maximum depth cost to build, to hold and to trace.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/depth.json and a plot beside it.
#include <memory>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "bench/build/report.h"
#include "bench/cli/bench_command.h"
#include "bench/cli/commands.h"

namespace kdray::cli {

namespace {

using DepthCommand = BenchCommand<bench::DepthOptions>;

int run(const DepthCommand& c) {
  require_scenes(c.options.scenes);
  const auto runs = run_bench("depth", c.options, c.report, bench::bench_depth);
  require_none(bench::count_not_identical(runs), "hits are not those over the tree of usual depth");
  return 0;
}

}  // namespace

Command add_bench_depth(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("depth", "Trees by their maximum depth: build time, trace time, memory, cost");
  const auto c = std::make_shared<DepthCommand>();
  bench::DepthOptions& o = c->options;
  add_scenes(*app, o.scenes);
  add_build_option(*app, o.quality);
  add_rays(*app, o.rays);
  add_usual(*app, *c);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
