// What    The results of `kdray bench instances` for people (a table), for programs (JSON) and for the eye
//         (a plot).
// Units   Mrays/s and seconds; every key of the JSON is in docs/bench.md.
#pragma once

#include <span>
#include <string>

#include "bench/instances/bench.h"
#include "bench/measure/json.h"
#include "bench/plot/plot.h"

namespace kdray::bench {

std::string table_of(const InstancesRun& run);
Json json_of(std::span<const InstancesRun> runs, const InstancesOptions& options);
Plot plot_of(std::span<const InstancesRun> runs, const InstancesOptions& options);

}  // namespace kdray::bench
