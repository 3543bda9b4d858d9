// What    A bench's results for people (a table), for programs (JSON) and for the eye (a plot).
// Units   Mrays/s and seconds; every key of the JSON is in docs/bench.md.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "bench/frames_bench.h"
#include "bench/plot.h"
#include "bench/rays_bench.h"

namespace kdray::bench {

using Json = nlohmann::ordered_json;

Json json_of(const Spread& spread);

std::string table_of(const RaysRun& run);
Json json_of(std::span<const RaysRun> runs, const RaysOptions& options);
Plot plot_of(std::span<const RaysRun> runs, const RaysOptions& options);

std::string table_of(const FrameResult& frame);
Json json_of(std::span<const FrameResult> frames, const FramesOptions& options);
Plot plot_of(std::span<const FrameResult> frames, const FramesOptions& options);

}  // namespace kdray::bench
