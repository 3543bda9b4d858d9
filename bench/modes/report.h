// What    The results of `kdray bench modes`, for people (tables), for programs (JSON) and for the eye
//         (plots).
// Units   Seconds; every key of the JSON is in docs/bench.md.
#pragma once

#include "bench/measure/json.h"
#include "bench/modes/bench.h"
#include "bench/plot/plot.h"
#include "bench/plot/xy_plot.h"

namespace kdray::bench {

// How much faster the thesis found PDPRT than ODPRT.
inline constexpr double kThesisLeast = 0.55, kThesisMost = 0.64;

// What was predicted beside what was measured: seconds, where every queue has a core; of ODPRT rays that were
// sent, always.
struct Check {
  std::string scheme, what;
  int queues = 1;
  double predicted = 0, measured = 0;
  double error() const { return predicted / measured - 1; }
};
std::vector<Check> checks_of(const ModesRun& run);

std::string table_of(const ModesRun& run, const ModesOptions& options);
std::string summary_of(std::span<const ModesRun> runs);
Json json_of(std::span<const ModesRun> runs, const ModesOptions& options);

XyPlot plot_of(std::span<const ModesRun> runs, const ModesOptions& options);        // speed-up over queues
XyPlot model_plot_of(std::span<const ModesRun> runs, const ModesOptions& options);  // efficiency, simulated
Plot time_plot_of(std::span<const ModesRun> runs, const ModesOptions& options);     // where ODPRT's time goes

}  // namespace kdray::bench
