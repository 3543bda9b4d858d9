#include "bench/race/build_race.h"

#include "accel/flatten/flatten.h"
#include "accel/flatten/wide.h"

namespace kdray::bench {

BuildSpreads spreads_of(std::span<const BuildTimes> times) {
  std::vector<double> tree, flatten, total, cpu;
  for (const BuildTimes& t : times) {
    tree.push_back(t.tree);
    flatten.push_back(t.flatten);
    total.push_back(t.tree + t.flatten);
    cpu.push_back(t.cpu);
  }
  return {spread_of(tree), spread_of(flatten), spread_of(total), spread_of(cpu)};
}

std::vector<BuildSpreads> race_builds(std::span<const TimedBuild> builds, int rounds) {
  for (const TimedBuild& build : builds) build();
  std::vector<std::vector<BuildTimes>> times(builds.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < builds.size(); ++i) times[i].push_back(builds[i]());
  std::vector<BuildSpreads> spreads;
  for (const auto& t : times) spreads.push_back(spreads_of(t));
  return spreads;
}

BuildTimes time_build(const scene::Scene& scene, const scene::Geometry& geometry,
                      const kdtree::BuildConfig& config) {
  BuildTimes times;
  const Stopwatch clock;
  const kdtree::Tree tree = kdtree::build(geometry, config);
  times.tree = clock.wall();
  constexpr bool kBinaryForm = false;  // a picture takes the wide one alone
  const flatten::FlatScene flat = flatten::flatten(scene, geometry, tree, kBinaryForm);
  const flatten::WideForm wide = flatten::make_wide(tree, flat, flatten::choose_block(tree));
  times.flatten = clock.wall() - times.tree;
  times.cpu = clock.cpu();
  return times;
}

}  // namespace kdray::bench
