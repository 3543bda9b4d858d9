// What    `kdray bench build --growth`: how the time for each triangle and the memory grow with the size of a
//         mesh, a displaced sphere of 10 thousand to 10 million triangles. The largest is built by all but
//         `best`.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/race/build_race.h"

namespace kdray::bench {

struct GrowthOptions {
  std::vector<std::size_t> sizes = {10000, 100000, 1000000, 10000000};  // triangles
  int repeat = 5;  // rounds; 3 at the most for the largest
  bool embree = true;
};

struct GrowthRow {
  std::string builder;
  BuildSpreads seconds;
  std::optional<std::uint64_t> peak_bytes;  // beyond the scene; where the system tells
  std::optional<double> duplication;        // references for each triangle; none of Embree's
};

struct GrowthResult {
  std::size_t n_triangles = 0;
  std::vector<GrowthRow> rows;
};

std::vector<GrowthResult> bench_growth(const GrowthOptions& options,
                                       const std::function<void(const GrowthResult&)>& done,
                                       const std::function<void(const std::string&)>& working);

}  // namespace kdray::bench
