// What    Embree's modes as contestants: single rays, packets of 8 and of 16, streams of 16 packets of 16,
//         each on a fast and on a robust scene, packets and streams with either flag for coherence.
// Shape   Of each Embree that is there (library.h); without one there are none, and embree_versions() is
//         empty. Modes begin with the major version: 4:16.
// Why     What each gets for its best: its own layout of rays, filled anew before each run and outside the
//         timed part, since Embree writes hits into the rays; chunks of 4096 rays drawn by threads that
//         already wait; denormals flushed; the vector width that the processor has (Embree's own default
//         stays at 256 bits on some). Scenes are built with quality medium, Embree's default.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/race/contestant.h"
#include "scene/model/scene.h"

namespace kdray::bench {

std::string embree_versions();  // "3.13.5 and 4.4.0"

namespace embree {
class Scenes;
}
using EmbreeScenes = std::vector<std::shared_ptr<embree::Scenes>>;  // of each Embree

// The scene's primitives, in the space and precision that kdray's tree has them in.
EmbreeScenes make_embree_scenes(const scene::Scene& scene);

std::vector<Contestant> embree_contestants(const EmbreeScenes& scenes, int threads);

}  // namespace kdray::bench
