// What    The results of `kdray bench frames` for people (a table), for programs (JSON) and for the eye
//         (a plot).
// Units   Mrays/s and seconds; every key of the JSON is in docs/bench.md.
#pragma once

#include <span>
#include <string>

#include "bench/frames/bench.h"
#include "bench/measure/json.h"
#include "bench/plot/plot.h"

namespace kdray::bench {

std::string table_of(const FrameResult& frame);
Json json_of(std::span<const FrameResult> frames, const FramesOptions& options);
Plot plot_of(std::span<const FrameResult> frames, const FramesOptions& options);

}  // namespace kdray::bench
