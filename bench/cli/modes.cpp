// What    kdray bench modes: one core alone, PDPRT and ODPRT on growing numbers of queues, and a model of
//         many more.
// Shape   Tables go to stderr, each as soon as its scene is done, then the means over all scenes; with
//         --report DIR the figures go to DIR/modes.json and plots beside it.
// Errors  Pictures that are not the same bits: exit code 1, after everything has been written. A mode that
//         fails is told.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/write_file.h"
#include "bench/cli/commands.h"
#include "bench/cli/limits.h"
#include "bench/cli/modes_ranks.h"
#include "bench/cli/report_files.h"
#include "bench/modes/report.h"
#include "bench/modes/timeline.h"
#include "cli/message.h"
#include "cli/options.h"
#include "cli/parse.h"

namespace kdray::cli {

namespace {

constexpr int kQueuesMax = 1024;

struct ModesCommand {
  bench::ModesOptions options;
  std::string report;
  bool ranks = false;
  RanksCommand of_ranks;
};

// "1,2,4": each once, in order.
std::vector<int> parse_queues(const std::string& text) {
  std::vector<int> queues;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    queues.push_back(parse_int("--queues", text.substr(start, comma - start), 1, kQueuesMax));
    start = comma + 1;
  }
  std::sort(queues.begin(), queues.end());
  queues.erase(std::unique(queues.begin(), queues.end()), queues.end());
  return queues;
}

void write_plot(const std::string& folder, const std::string& name, const std::string& svg) {
  if (!folder.empty()) write_file(std::filesystem::path(folder) / name, svg);
}

int run(const ModesCommand& c) {
  require_scenes(c.options.scenes);
  if (c.ranks) return run_ranks_bench(c.of_ranks, c.options, c.report);
  prepare_report(c.report, "modes");
  const auto runs = bench::bench_modes(
      c.options, [&](const bench::ModesRun& run) { print_table(bench::table_of(run, c.options)); },
      [](const std::string& what) { say(what); });
  print_table(bench::summary_of(runs));
  write_report(c.report, "modes", bench::json_of(runs, c.options), to_svg(bench::plot_of(runs, c.options)));
  write_plot(c.report, "modes_time.svg", to_svg(bench::time_plot_of(runs, c.options)));
  if (const std::string svg = bench::timeline_svg(runs, c.options); !svg.empty())
    write_plot(c.report, "modes_timeline.svg", svg);
  if (c.options.model) write_plot(c.report, "modes_model.svg", to_svg(bench::model_plot_of(runs, c.options)));
  if (const std::size_t n = bench::count_differing_pixels(runs); n > 0)
    throw Error(ErrorCode::internal, fmt::format("{} pixels are not the bits of the first picture", n));
  return 0;
}

}  // namespace

Command add_bench_modes(CLI::App& bench) {
  CLI::App* const app = bench.add_subcommand(
      "modes", "PDPRT and ODPRT against one core alone, and a model of up to 10,000 queues");
  const auto c = std::make_shared<ModesCommand>();
  bench::ModesOptions& o = c->options;
  add_scenes(*app, o.scenes, "balls gears mount rings teapot tetra tree");
  add_text(*app, "--queues", "LIST", "Numbers of queues (default 1,2,4,8)",
           [&o](const std::string& text) { o.queues = parse_queues(text); });
  add_size(*app, "Pixels across and down (default 1024x1024)", kSideMax, kPixelsMax, o.width, o.height);
  add_int(*app, "--depth", "Deepest ray; the eye ray is 1 (default 5)", 1, 64, o.depth);
  add_int(*app, "--repeat", "Rounds to take the median of (default 7)", 1, kRepeatMax, o.repeat);
  add_real(*app, "--bandwidth", "GB/s", "Of a link between queues, for the model (default 10)", 1e-6, 1e9,
           o.model_options.gigabytes_per_second);
  add_real(*app, "--latency", "US", "Microseconds from queue to queue, for the model (default 2)", 0, 1e9,
           o.model_options.latency_us);
  add_int(*app, "--sample", "Eye rays that the model follows (default 65536)", 1, 1 << 24,
          o.model_options.sample);
  app->add_flag_callback(
      "--no-model", [&o] { o.model = false; }, "Measure only");
  add_ranks(*app, c->ranks, c->of_ranks);
  add_report(*app, c->report);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
