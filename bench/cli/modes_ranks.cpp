#include "bench/cli/modes_ranks.h"

#include <fmt/format.h>

#include "bench/cli/report_files.h"
#include "bench/ranks/report.h"
#include "cli/message.h"
#include "cli/options.h"
#include "cli/rank_cores.h"
#include "kdray/error.h"
#include "transport/launcher.h"
#include "transport/mpi.h"

namespace kdray::cli {

namespace {

constexpr int kSamplesMax = 1024;

bench::RanksOptions options_of(const RanksCommand& c, const bench::ModesOptions& o, int most_ranks) {
  bench::RanksOptions options;
  options.scenes = o.scenes;
  bench::RanksAsked& asked = options.asked;
  asked.ranks.clear();
  for (const int ranks : o.queues)
    if (ranks <= most_ranks) asked.ranks.push_back(ranks);
  asked.delays = {0};
  if (c.delay_ms > 0) asked.delays.push_back(1e-3 * c.delay_ms);
  asked.width = o.width, asked.height = o.height, asked.depth = o.depth, asked.repeat = o.repeat;
  asked.samples = c.samples;
  asked.device = o.device;
  return options;
}

}  // namespace

void add_ranks(CLI::App& app, bool& ranks, RanksCommand& command) {
  app.add_flag("--ranks", ranks,
               "Ranks instead of queues: the protocol over a simulated network, held against real runs; "
               "under mpirun these go over MPI");
  add_int(app, "--samples", "Samples for each pixel, with --ranks (default 1)", 1, kSamplesMax,
          command.samples);
  add_real(app, "--delay", "MS",
           "Milliseconds that messages are held back in half of the real runs of ranks "
           "(default 2.5; 0: none)",
           0, 1000, command.delay_ms);
}

int run_ranks_bench(const RanksCommand& command, const bench::ModesOptions& options,
                    const std::string& report) {
  const transport::Launched launched = transport::launched();
  const bool over_mpi = launched.ranks > 1;
  const int n_threads = options.queues.back();
  const bench::RanksOptions asked = options_of(command, options, over_mpi ? launched.ranks : n_threads);
  if (launched.rank == 0) prepare_report(report, "ranks");
  std::vector<bench::RanksRun> runs;
  bench::SceneShelf shelf;
  bench::run_team(over_mpi ? transport::open_mpi(launched.ranks) : nullptr, n_threads,
                  [&](bench::Team& team) {
                    if (over_mpi) {
                      transport::Ranks all(team.group(team.size()));
                      share_cores(all);
                    }
                    auto of_member = bench::bench_ranks(
                        team, shelf, over_mpi, asked,
                        [&](const bench::RanksRun& run) { print_table(bench::table_of(run, asked)); },
                        [](const std::string& what) { say(what); });
                    if (team.leads()) runs = std::move(of_member);
                  });
  if (launched.rank != 0) return 0;
  write_report(report, "ranks", bench::json_of(runs, asked), to_svg(bench::plot_of(runs, asked)));
  if (bench::count_differing_pixels(runs) > 0)
    throw Error(ErrorCode::internal, "some ranks' pictures are not the bits of one core's");
  return 0;
}

}  // namespace kdray::cli
