// What    The results of `kdray bench modes --ranks`, for people, for programs and for the eye.
// Units   Seconds; every key of the JSON is in docs/bench.md.
#pragma once

#include <string>

#include "bench/measure/json.h"
#include "bench/plot/xy_plot.h"
#include "bench/ranks/bench.h"

namespace kdray::bench {

std::string table_of(const RanksRun& run, const RanksOptions& options);
Json json_of(const std::vector<RanksRun>& runs, const RanksOptions& options);
XyPlot plot_of(const std::vector<RanksRun>& runs, const RanksOptions& options);

}  // namespace kdray::bench
