// What    Embree's build of a scene's primitives with quality medium, its default, for the clock.
// Shape   Vertices and indices lie ready in shared buffers, the mesh indexed as the scene has it; the clock
//         runs for rtcCommitScene alone.
#pragma once

#include "bench/race/build_race.h"

namespace kdray::bench {

// What it returns is empty without Embree. The scene and its geometry may go.
TimedBuild embree_build(const scene::Scene& scene, const scene::Geometry& geometry);

}  // namespace kdray::bench
