// What    bench build --growth, and its report.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/process_memory.h"
#include "bench/build/bench.h"
#include "bench/embree/embree.h"
#include "scene/generate/displaced_sphere.h"

namespace kdray::bench {

namespace {

constexpr std::size_t kLarge = 5000000;  // triangles, from which on time is short
constexpr int kRoundsOfLarge = 3;

double duplication_of(const scene::Geometry& geometry, const kdtree::BuildConfig& config) {
  return static_cast<double>(kdtree::build(geometry, config).refs.size()) /
         static_cast<double>(geometry.size());
}

GrowthResult measure_size(std::size_t n, const GrowthOptions& options) {
  const BuildInput input(generate::displaced_sphere_of(n));
  GrowthResult result{input.geometry.size(), {}};
  std::vector<TimedBuild> builds;
  std::vector<Builder> builders = quality_builders(input.geometry.size());
  if (n >= kLarge) std::erase_if(builders, [](const Builder& b) { return b.name == "best"; });
  for (const Builder& b : builders) {
    builds.push_back([&] { return time_build(input.scene, input.geometry, b.config); });
    result.rows.push_back({b.name, {}, {}, duplication_of(input.geometry, b.config)});
  }
  if (options.embree)
    for (EmbreeBuild& embree : embree_builds(input.scene, input.geometry)) {
      builds.push_back(std::move(embree.build));
      result.rows.push_back({embree.name, {}, {}, {}});
    }
  for (std::size_t i = 0; i < builds.size(); ++i)
    result.rows[i].peak_bytes = peak_bytes_of([&] { builds[i](); });
  const int rounds = n >= kLarge ? std::min(options.repeat, kRoundsOfLarge) : options.repeat;
  const std::vector<BuildSpreads> seconds = race_builds(builds, rounds);
  for (std::size_t i = 0; i < builds.size(); ++i) result.rows[i].seconds = seconds[i];
  return result;
}

double nanoseconds_each(const GrowthResult& result, const GrowthRow& row) {
  return 1e9 * row.seconds.total.median / static_cast<double>(result.n_triangles);
}

// How much longer each triangle takes than at the smallest size that was measured with this builder, for each
// doubling of their number.
double growth(std::span<const GrowthResult> results, const GrowthResult& result, const GrowthRow& row) {
  const auto each = [&](const GrowthResult& r, const GrowthRow& b) {
    return nanoseconds_each(r, b) / std::log2(static_cast<double>(r.n_triangles));
  };
  for (const GrowthResult& r : results)
    for (const GrowthRow& b : r.rows)
      if (b.builder == row.builder) return each(result, row) / each(r, b);
  return 1;
}

}  // namespace

std::vector<GrowthResult> bench_growth(const GrowthOptions& options, const Progress<GrowthResult>& progress) {
  return run_each(options.sizes, progress, [&](std::size_t n) {
    progress.working(fmt::format("{} triangles", n));
    return measure_size(n, options);
  });
}

std::string table_of(const GrowthResult& result) {
  std::string out = fmt::format("{} triangles\n  {:<15}{}{:>9}{:>7}{:>9}\n", result.n_triangles,
                                "milliseconds", times_heading(), "ns each", "refs", "peak MB");
  for (const GrowthRow& row : result.rows) {
    out += fmt::format("  {:<15}{}{:>9.1f}", row.builder, times_cells(row.seconds),
                       nanoseconds_each(result, row));
    out += row.duplication ? fmt::format("{:>7.2f}", *row.duplication) : fmt::format("{:>7}", "");
    out +=
        row.peak_bytes ? fmt::format("{:>9.1f}\n", millions(*row.peak_bytes)) : fmt::format("{:>9}\n", "-");
  }
  return out;
}

Json json_of(std::span<const GrowthResult> results, const GrowthOptions& options) {
  const auto size = [&](const GrowthResult& r) -> Json {
    const auto builder = [&](const GrowthRow& row) -> Json {
      return {{"builder", row.builder},
              {"seconds", json_of(row.seconds)},
              {"nanoseconds_per_triangle", nanoseconds_each(r, row)},
              {"growth_over_n_log_n", growth(results, r, row)},
              {"duplication", json_if(row.duplication)},
              {"peak_bytes", json_if(row.peak_bytes)}};
    };
    return {{"triangles", r.n_triangles}, {"builders", json_list(r.rows, builder)}};
  };
  return {{"command", "bench build --growth"},
          {"embree", embree_json(options.embree)},
          {"repeat", options.repeat},
          {"sizes", json_list(results, size)}};
}

}  // namespace kdray::bench
