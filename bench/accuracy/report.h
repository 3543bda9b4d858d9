// What    The results of `kdray bench accuracy` for people (a table), for programs (JSON) and for the eye (a
//         plot).
// Units   Errors in linear light, 1 is white; times in seconds, in tables and plots in milliseconds. Every
//         key of the JSON is in docs/bench.md.
#pragma once

#include "bench/accuracy/bench.h"
#include "bench/measure/json.h"
#include "bench/plot/scatter_plot.h"

namespace kdray::bench {

std::string table_of(const AccuracyRun& run);
Json json_of(std::span<const AccuracyRun> runs, const AccuracyOptions& options);
ScatterPlot plot_of(std::span<const AccuracyRun> runs, const AccuracyOptions& options);

// The file of a picture: "balls_16_samples_depth_16_base.png".
std::string picture_name(const std::string& scene, const std::string& name);

}  // namespace kdray::bench
