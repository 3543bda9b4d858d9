// What    The results of `kdray bench rays` for people (a table), for programs (JSON) and for the eye
//         (a plot).
// Units   Mrays/s and seconds; every key of the JSON is in docs/bench.md.
#pragma once

#include <span>
#include <string>

#include "bench/measure/json.h"
#include "bench/plot/plot.h"
#include "bench/rays/bench.h"

namespace kdray::bench {

std::string table_of(const RaysRun& run);
Json json_of(std::span<const RaysRun> runs, const RaysOptions& options);
Plot plot_of(std::span<const RaysRun> runs, const RaysOptions& options);

}  // namespace kdray::bench
