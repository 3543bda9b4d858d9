// What    kdray bench modes: one core alone, PDPRT and ODPRT on growing numbers of queues, and a model of
//         many more; with --ranks by ranks, of this process or of several that mpirun has started.
// Errors  A mode that fails is told.
#include <algorithm>

#include "apps/cli/output.h"
#include "bench/cli/bench_command.h"
#include "bench/modes/bench.h"
#include "bench/ranks/bench.h"
#include "cluster/transport/mpi.h"
#include "kdray/error.h"

namespace kdray::cli {

namespace {

constexpr int kQueuesMax = 1024, kSamplesMax = 1024;

struct ModesCommand : BenchCommand<bench::ModesOptions> {
  bool ranks = false;
  int samples = 1;        // with ranks
  double delay_ms = 2.5;  // too
};

bench::RanksOptions options_of_ranks(const ModesCommand& c, int most_ranks) {
  const bench::ModesOptions& o = c.options;
  bench::RanksOptions options{.scenes = o.scenes,
                              .ranks = o.queues,
                              .delays = {0},
                              .width = o.width,
                              .height = o.height,
                              .depth = o.depth,
                              .samples = c.samples,
                              .repeat = o.repeat,
                              .device = o.device};
  std::erase_if(options.ranks, [&](int ranks) { return ranks > most_ranks; });
  if (c.delay_ms > 0) options.delays.push_back(1e-3 * c.delay_ms);
  return options;
}

void add_ranks(CLI::App& app, ModesCommand& c) {
  app.add_flag(
      "--ranks", c.ranks,
      "Ranks instead of queues, and what the network costs; under mpirun they go over MPI, else they are "
      "threads");
  add_int(app, "--samples", "Samples for each pixel, with --ranks (default 1)", 1, kSamplesMax, c.samples);
  add_real(app, "--delay", "MS",
           "Milliseconds that messages are held back in half of the runs of ranks "
           "(default 2.5; 0: none)",
           0, 1000, c.delay_ms);
}

int run_ranks(const ModesCommand& c) {
  const transport::Launched launched = transport::launched();
  const bool over_mpi = launched.ranks > 1;
  const int n_threads = c.options.queues.back();
  const bench::RanksOptions asked = options_of_ranks(c, over_mpi ? launched.ranks : n_threads);
  if (launched.rank == 0) prepare_report(c.report, "ranks");
  std::vector<bench::RanksRun> runs;
  bench::SceneShelf shelf;
  bench::run_team(
      over_mpi ? transport::open_mpi(launched.ranks) : nullptr, n_threads, [&](bench::Team& team) {
        if (over_mpi) {
          transport::Ranks all(team.group(team.size()));
          transport::share_cores(all);
        }
        auto of_member = bench::bench_ranks(
            team, shelf, over_mpi, asked,
            {[&](const bench::RanksRun& run) { print_table(bench::table_of(run, asked)); }, say_working});
        if (team.leads()) runs = std::move(of_member);
      });
  if (launched.rank != 0) return 0;
  write_report(c.report, "ranks", bench::json_of(runs, asked));
  require_none(bench::count_differing_pictures(runs),
               "of the ranks' pictures are not the bits of one core's");
  return 0;
}

int run(const ModesCommand& asked) {
  require_scenes(asked.options.scenes);
  ModesCommand c = asked;  // numbers of queues each once, in order
  std::ranges::sort(c.options.queues);
  c.options.queues.erase(std::unique(c.options.queues.begin(), c.options.queues.end()),
                         c.options.queues.end());
  if (c.ranks) return run_ranks(c);
  const auto runs = run_bench("modes", c.options, c.report, bench::bench_modes);
  print_table(bench::summary_of(runs));
  require_none(bench::count_differing_pixels(runs), "pixels are not the bits of the first picture");
  return 0;
}

void add_options(CLI::App& app, ModesCommand& c) {
  bench::ModesOptions& o = c.options;
  add_scenes(app, o.scenes);
  add_values(app, "--queues", "Numbers of queues (default 1,2,4,8)", o.queues,
             [](const auto& option, const auto& text) { return parse_int(option, text, 1, kQueuesMax); });
  add_picture_size(app, kPixelsMax, o.width, o.height);
  add_depth(app, o.depth);
  add_real(app, "--bandwidth", "GB/s", "Of a link between queues, for the model (default 10)", 1e-6, 1e9,
           o.model_options.gigabytes_per_second);
  add_real(app, "--latency", "US", "Microseconds from queue to queue, for the model (default 2)", 0, 1e9,
           o.model_options.latency_us);
  add_int(app, "--sample", "Eye rays that the model follows (default 65536)", 1, 1 << 24,
          o.model_options.sample);
  app.add_flag_callback(
      "--no-model", [&o] { o.model = false; }, "Measure only");
  add_ranks(app, c);
}

}  // namespace

Command add_bench_modes(CLI::App& bench) {
  return add_command(bench, "modes",
                     "PDPRT and ODPRT against one core alone, and a model of up to 10,000 queues",
                     add_options, run);
}

}  // namespace kdray::cli
