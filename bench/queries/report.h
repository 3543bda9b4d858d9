// What    The results of `kdray bench queries` for people (a table), for programs (JSON) and for the eye
//         (a plot).
// Units   The table has microseconds for a call; the JSON seconds. Every key of the JSON is in docs/bench.md.
#pragma once

#include <span>
#include <string>

#include "bench/measure/json.h"
#include "bench/plot/xy_plot.h"
#include "bench/queries/bench.h"

namespace kdray::bench {

std::string table_of(const QueriesRun& run);
Json json_of(std::span<const QueriesRun> runs, const QueriesOptions& options);
XyPlot plot_of(std::span<const QueriesRun> runs, const QueriesOptions& options);

}  // namespace kdray::bench
