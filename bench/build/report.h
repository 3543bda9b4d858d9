// What    The results of the benches that build trees, for people (a table) and for programs (JSON).
// Units   Seconds; milliseconds in tables. Every key of the JSON is in docs/bench.md.
#pragma once

#include "bench/build/bench.h"
#include "bench/build/depth.h"
#include "bench/build/growth.h"
#include "bench/build/hostile.h"
#include "bench/measure/json.h"

namespace kdray::bench {

Json json_of(const BuildSpreads& seconds);
Json json_of(const TreeFacts& tree);

std::string table_of(const BuildRun& run);
Json json_of(std::span<const BuildRun> runs, const BuildOptions& options);

std::string table_of(const GrowthResult& result);
Json json_of(std::span<const GrowthResult> results, const GrowthOptions& options);

std::string table_of(const DepthRun& run);
Json json_of(std::span<const DepthRun> runs, const DepthOptions& options);

std::string hostile_heading();
std::string table_of(const HostileResult& result);
Json json_of(std::span<const HostileResult> results, const HostileOptions& options);

}  // namespace kdray::bench
