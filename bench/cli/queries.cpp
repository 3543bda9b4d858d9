// What    kdray bench queries: the same questions to kdray and to Embree, from arrays to arrays, in batches
//         of several sizes.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/queries.json and a plot beside it.
#include <memory>
#include <string>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "base/text.h"
#include "bench/cli/bench_command.h"
#include "bench/cli/commands.h"
#include "bench/queries/bench.h"

namespace kdray::cli {

namespace {

using QueriesCommand = BenchCommand<bench::QueriesOptions>;

int run(const QueriesCommand& c) {
  require_scenes(c.options.scenes);
  run_bench("queries", c.options, c.report, bench::bench_queries);
  return 0;
}

std::vector<int> parse_batches(const std::string& text) {
  std::vector<int> batches;
  for (const std::string& item : split_list(text))
    batches.push_back(parse_int("--batches", item, 1, kRaysMax));
  return batches;
}

}  // namespace

Command add_bench_queries(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("queries", "The same questions from arrays, to kdray and to Embree");
  const auto c = std::make_shared<QueriesCommand>();
  bench::QueriesOptions& o = c->options;
  add_scenes(*app, o.scenes);
  add_list(*app, "--queries", "Questions (default: all)", bench::question_names(), o.questions);
  add_list(*app, "--sets", "Sets of rays (default: all)", bench::set_names(), o.sets);
  add_text(*app, "--batches", "LIST", "Rays or points to a call (default 1,100,10000,1000000)",
           [&o](const std::string& text) { o.batches = parse_batches(text); });
  add_int(*app, "--rays", "Rays or points of a set (default 1000000)", 1, kRaysMax, o.rays);
  add_no_embree(*app, o.embree);
  add_geometry_option(*app, o.geometry);
  add_usual(*app, *c);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
