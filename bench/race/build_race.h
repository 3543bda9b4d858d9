// What    Builders of trees against each other: what each takes on the wall clock and of all cores' time.
// Shape   A warm-up first, then rounds, in each of which every builder runs once: what slows the machine for
//         a while slows all of them.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "accel/kdtree/build.h"
#include "bench/measure/report.h"
#include "bench/measure/stopwatch.h"
#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::bench {

// Seconds. `tree` and `flatten` (to the forms that a device uses) are wall time, `cpu` the process' time for
// both.
struct BuildTimes {
  double tree = 0, flatten = 0, cpu = 0;
};

using TimedBuild = std::function<BuildTimes()>;

struct BuildSpreads {
  Spread tree, flatten, total, cpu;
};

// Returns the spreads in the order of `builds`.
std::vector<BuildSpreads> race_builds(std::span<const TimedBuild> builds, int rounds);

BuildSpreads spreads_of(std::span<const BuildTimes> times);

// Builds a tree and all its forms, and forgets them.
BuildTimes time_build(const scene::Scene& scene, const scene::Geometry& geometry,
                      const kdtree::BuildConfig& config);

}  // namespace kdray::bench
