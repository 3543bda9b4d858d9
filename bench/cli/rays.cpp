// What    kdray bench rays: the same rays through every traversal of kdray's, and through Embree.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/rays.json and a plot beside it.
// Errors  Hits that differ between kdray's traversals: exit code 1, after everything has been written.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <string>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "base/text.h"
#include "bench/cli/bench_command.h"
#include "bench/cli/commands.h"
#include "bench/race/kdray_contestants.h"
#include "bench/rays/bench.h"
#include "bench/workload/rays.h"
#include "bench/workload/scenes.h"

namespace kdray::cli {

namespace {

constexpr int kCoresMax = 4096;

using RaysCommand = BenchCommand<bench::RaysOptions>;

void say_missing_data() {
  if (const auto missing = bench::data_scenes().missing; !missing.empty())
    say(fmt::format("left out, since KDRAY_DATA names no folder that has them: {}", fmt::join(missing, " ")));
}

int run(const RaysCommand& c) {
  if (c.options.scenes.empty()) say_missing_data();
  require_scenes(c.options.scenes);
  const auto runs = run_bench("rays", c.options, c.report, bench::bench_rays);
  require_none(bench::count_not_identical(runs),
               "hits of kdray's traversals are not identical to the binary one's");
  return 0;
}

// "1,all": numbers of cores, 0 for all.
std::vector<int> parse_cores(const std::string& text) {
  std::vector<int> cores;
  for (const std::string& item : split_list(text))
    cores.push_back(item == "all" ? 0 : parse_int("--cores", item, 1, kCoresMax));
  return cores;
}

}  // namespace

Command add_bench_rays(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("rays", "The same rays through every traversal, and through Embree");
  const auto c = std::make_shared<RaysCommand>();
  bench::RaysOptions& o = c->options;
  add_scenes(*app, o.scenes, fmt::format("{}", fmt::join(bench::default_scenes(), " ")));
  add_list(*app, "--classes", "Of rays (default: all)", bench::class_names(), o.classes);
  add_list(*app, "--traversals", "Ways through the tree (default: all)", bench::traversal_names(),
           o.traversals);
  add_rays(*app, o.rays);
  add_text(*app, "--cores", "LIST", "Numbers of cores, or all (default 1,all; on a GPU all)",
           [&o](const std::string& text) { o.cores = parse_cores(text); });
  add_no_embree(*app, o.embree);
  add_usual(*app, *c);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
