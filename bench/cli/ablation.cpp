// What    kdray bench ablation: what each specialisation and each rule of skipping is worth.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/ablation.json and a plot beside it.
// Errors  A picture that changes where a rule claims to be exact: exit code 1, after everything has been
//         written.
#include <memory>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "bench/ablation/bench.h"
#include "bench/cli/bench_command.h"
#include "bench/cli/commands.h"

namespace kdray::cli {

namespace {

using AblationCommand = BenchCommand<bench::AblationOptions>;

int run(const AblationCommand& c) {
  require_scenes(c.options.scenes);
  const auto runs = run_bench("ablation", c.options, c.report, bench::bench_ablation);
  require_none(bench::count_inexact(runs), "pictures changed where none may");
  return 0;
}

}  // namespace

Command add_bench_ablation(CLI::App& bench) {
  CLI::App* const app = bench.add_subcommand(
      "ablation", "What each specialisation and each rule of skipping is worth: one at a time off");
  const auto c = std::make_shared<AblationCommand>();
  bench::AblationOptions& o = c->options;
  add_scenes(*app, o.scenes);
  add_picture_size(*app, kPixelsMax, o.width, o.height);
  add_depth(*app, o.depth);
  app->add_option("--only", o.only, "Take away these alone, by their names in the table")
      ->type_name("NAME...");
  add_usual(*app, *c);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
