// What    kdray bench ablation: what each specialisation and each rule of skipping is worth.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/ablation.json and a plot beside it.
// Errors  A picture that changes where a rule claims to be exact: exit code 1, after everything has been
//         written.
#include <fmt/format.h>

#include <memory>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "bench/ablation/bench.h"
#include "bench/cli/commands.h"
#include "bench/cli/limits.h"
#include "bench/cli/report_files.h"

namespace kdray::cli {

namespace {

struct AblationCommand {
  bench::AblationOptions options;
  std::string report;
};

int run(const AblationCommand& c) {
  require_scenes(c.options.scenes);
  prepare_report(c.report, "ablation");
  const auto runs = bench::bench_ablation(
      c.options, [](const bench::AblationRun& run) { print_table(bench::table_of(run)); },
      [](const std::string& what) { say(what); });
  write_report(c.report, "ablation", bench::json_of(runs, c.options));
  if (const std::size_t n = bench::count_inexact(runs); n > 0)
    throw Error(ErrorCode::internal, fmt::format("{} pictures changed where none may", n));
  return 0;
}

}  // namespace

Command add_bench_ablation(CLI::App& bench) {
  CLI::App* const app = bench.add_subcommand(
      "ablation", "What each specialisation and each rule of skipping is worth: one at a time off");
  const auto c = std::make_shared<AblationCommand>();
  bench::AblationOptions& o = c->options;
  add_scenes(*app, o.scenes, "balls gears mount rings teapot tetra tree boxes spheres");
  add_size(*app, "Pixels across and down (default 1024x1024)", kSideMax, kPixelsMax, o.width, o.height);
  add_int(*app, "--depth", "Deepest ray; the eye ray is 1 (default 5)", 1, 32, o.depth);
  add_int(*app, "--repeat", "Rounds to take the median of (default 5)", 1, kRepeatMax, o.repeat);
  app->add_option("--only", o.only, "Take away these alone, by their names in the table")
      ->type_name("NAME...");
  add_device_option(*app, "The device, as for render (default: auto)", o.device);
  add_report(*app, c->report);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
