// What    Embree's modes as contestants: single rays, packets of 8 and of 16, streams of 16 packets of 16,
//         each on a fast and on a robust scene, packets and streams with either flag for coherence.
// Shape   Without Embree (no_embree.cpp) there are none, and embree_version() is empty.
// Why     What each gets for its best: its own layout of rays, filled anew before each run and outside the
//         timed part, since Embree writes hits into the rays; chunks of 4096 rays drawn by threads that
//         already wait; denormals flushed; the vector width that the processor has (Embree's own default
//         stays at 256 bits on some). Scenes are built with quality medium, Embree's default.
#pragma once

#include <memory>
#include <string>

#include "bench/race/contestant.h"
#include "scene/model/scene.h"

namespace kdray::bench {

std::string embree_version();  // "3.13.5"

class EmbreeScenes;

// The scene's primitives, in the space and precision that kdray's tree has them in. Null without Embree.
std::shared_ptr<EmbreeScenes> make_embree_scenes(const scene::Scene& scene);

// There are none without Embree.
std::vector<Contestant> embree_contestants(const std::shared_ptr<EmbreeScenes>& scenes, int threads);

// Closest hits with packets of 16 flagged as coherent, on the fast scene: what whole frames are scaled by.
Traced trace_embree16(const std::shared_ptr<EmbreeScenes>& scenes, const RayClass& rays, int threads);

}  // namespace kdray::bench
