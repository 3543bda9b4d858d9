// What    kdray bench queries: the same questions to kdray and to Embree, from arrays to arrays, in batches
//         of several sizes.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/queries.json and a plot beside it.
#include <memory>
#include <string>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "bench/cli/commands.h"
#include "bench/cli/limits.h"
#include "bench/cli/report_files.h"
#include "bench/queries/bench.h"

namespace kdray::cli {

namespace {

struct QueriesCommand {
  bench::QueriesOptions options;
  std::string report;
};

int run(const QueriesCommand& c) {
  require_scenes(c.options.scenes);
  prepare_report(c.report, "queries");
  if (c.options.embree) say_without_embree();
  const auto runs = bench::bench_queries(
      c.options, [](const bench::QueriesRun& run) { print_table(bench::table_of(run)); },
      [](const std::string& what) { say(what); });
  write_report(c.report, "queries", bench::json_of(runs, c.options));
  return 0;
}

std::vector<int> parse_batches(const std::string& text) {
  std::vector<int> batches;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    batches.push_back(parse_int("--batches", text.substr(start, comma - start), 1, kRaysMax));
    start = comma + 1;
  }
  return batches;
}

}  // namespace

Command add_bench_queries(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("queries", "The same questions from arrays, to kdray and to Embree");
  const auto c = std::make_shared<QueriesCommand>();
  bench::QueriesOptions& o = c->options;
  add_scenes(*app, o.scenes, "boxes spheres");
  add_list(*app, "--queries", "Questions (default: all)", bench::question_names(), o.questions);
  add_list(*app, "--sets", "Sets of rays (default: all)", bench::set_names(), o.sets);
  add_text(*app, "--batches", "LIST", "Rays or points to a call (default 1,100,10000,1000000)",
           [&o](const std::string& text) { o.batches = parse_batches(text); });
  add_int(*app, "--rays", "Rays or points of a set (default 1000000)", 1, kRaysMax, o.rays);
  add_int(*app, "--repeat", "Rounds to take the median of (default 5)", 1, kRepeatMax, o.repeat);
  app->add_flag_callback(
      "--no-embree", [&o] { o.embree = false; }, "Leave Embree out");
  add_geometry_option(*app, o.geometry);
  add_device_option(*app, "The device, as for render (default: auto)", o.device);
  add_report(*app, c->report);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
