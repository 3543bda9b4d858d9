// What    Embree's build of a scene's primitives with quality medium, its default, for the clock.
// Shape   Vertices and indices lie ready in shared buffers, the mesh indexed as the scene has it; the clock
//         runs for rtcCommitScene alone.
#pragma once

#include <string>
#include <vector>

#include "bench/race/build_race.h"

namespace kdray::bench {

struct EmbreeBuild {
  std::string name;  // "Embree 4 medium"
  TimedBuild build;
};

// Of each Embree that is there. The scene and its geometry may go.
std::vector<EmbreeBuild> embree_builds(const scene::Scene& scene, const scene::Geometry& geometry);

}  // namespace kdray::bench
