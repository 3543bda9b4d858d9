// What    The results of `kdray bench ablation`, for people (a table), for programs (JSON) and for the eye (a
//         plot).
// Units   Seconds; every key of the JSON is in docs/bench.md.
#pragma once

#include <span>
#include <string>

#include "bench/ablation/bench.h"
#include "bench/measure/json.h"

namespace kdray::bench {

std::string table_of(const AblationRun& run);
Json json_of(std::span<const AblationRun> runs, const AblationOptions& options);

// SVG: for each scene how much longer a frame takes without each thing, on a logarithmic axis.
std::string plot_of(std::span<const AblationRun> runs, const AblationOptions& options);

}  // namespace kdray::bench
