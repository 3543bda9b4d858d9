#include "bench/build/growth.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/process_memory.h"
#include "bench/build/bench.h"
#include "bench/build/builders.h"
#include "bench/embree/build.h"
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
  const scene::Scene scene = generate::displaced_sphere_of(n);
  const scene::Geometry geometry = scene::make_geometry(scene);
  GrowthResult result{geometry.size(), {}};
  std::vector<TimedBuild> builds;
  std::vector<Builder> builders = quality_builders(geometry.size());
  if (n >= kLarge) std::erase_if(builders, [](const Builder& b) { return b.name == "best"; });
  for (const Builder& b : builders) {
    builds.push_back([&scene, &geometry, &b] { return time_build(scene, geometry, b.config); });
    result.rows.push_back({b.name, {}, {}, duplication_of(geometry, b.config)});
  }
  if (options.embree)
    for (EmbreeBuild& embree : embree_builds(scene, geometry)) {
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

}  // namespace

std::vector<GrowthResult> bench_growth(const GrowthOptions& options,
                                       const std::function<void(const GrowthResult&)>& done,
                                       const std::function<void(const std::string&)>& working) {
  std::vector<GrowthResult> results;
  for (const std::size_t n : options.sizes) {
    working(fmt::format("{} triangles", n));
    results.push_back(measure_size(n, options));
    done(results.back());
  }
  return results;
}

}  // namespace kdray::bench
