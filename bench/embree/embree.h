// What    Embree's modes as contestants: single rays, packets of 8 and of 16, streams of 16 packets of 16,
//         each on a fast and on a robust scene, packets and streams with either flag for coherence.
// Shape   Of each Embree that is there (library.h); without one there are none, and embree_versions() is
//         empty. Modes begin with the major version: 4:16.
// Why     What each gets for its best: its own layout of rays, filled anew before each run and outside the
//         timed part, since Embree writes hits into the rays; chunks of 4096 rays drawn by threads that
//         already wait; denormals flushed; the vector width that the processor has (Embree's own default
//         stays at 256 bits on some). Scenes are built with quality medium, Embree's default.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/race/asker.h"
#include "bench/race/build_race.h"
#include "bench/race/race.h"
#include "scene/model/scene.h"

namespace kdray::bench {

std::string embree_versions();     // "3.13.5 and 4.4.0"
Json embree_json(bool is_wanted);  // that; null where there is none, or where it was left out

namespace embree {
class Scenes;
}
using EmbreeScenes = std::vector<std::shared_ptr<embree::Scenes>>;  // of each Embree

// The scene's primitives, in the space and precision that kdray's tree has them in.
EmbreeScenes make_embree_scenes(const scene::Scene& scene);

std::vector<Contestant> embree_contestants(const EmbreeScenes& scenes, int threads);

// Embree's build of a scene's primitives with quality medium, its default, for the clock: vertices and
// indices lie ready in shared buffers, the mesh indexed as the scene has it, and the clock runs for
// rtcCommitScene alone.
struct EmbreeBuild {
  std::string name;  // "Embree 4 medium"
  TimedBuild build;
};

// Of each Embree that is there. The scene and its geometry may go.
std::vector<EmbreeBuild> embree_builds(const scene::Scene& scene, const scene::Geometry& geometry);

// The sides of `bench queries`: a fast scene and a robust one, each in the forms of all Embrees that are
// there. A first answer is the newest one's. The mesh has to outlive them.
std::vector<Side> embree_sides(const MeshArrays& mesh, int threads);

// Whether Embree has a way to answer it.
bool embree_answers(Question question);

// Whole frames by Embree, for NFF's model (docs/scenes.md): eye rays, shadow rays to each point light,
// reflection, refraction. A tile of 16 x 16 pixels at a time, generation by generation; all rays in packets
// of 16, eye and shadow rays flagged as coherent, shadow rays light by light. Tiles are dealt out by TBB.
// Fast scenes.
struct EmbreeFrameOptions {
  int width = 0, height = 0, depth = 0;
  double spawn_threshold = 0;  // the least weight of a ray
  int threads = 1;
};

struct EmbreePicture {
  double seconds = 0;
  std::uint64_t n_rays = 0;
  std::vector<vec3> rgb;  // linear, row by row from the top left
};

struct EmbreeFrames {
  std::string name;  // "Embree 4"
  std::function<EmbreePicture()> render;
};

// By each Embree that is there. The scene has a camera and nothing beyond NFF's model: point lights, no
// instances, no textures; it has to outlive what is returned.
std::vector<EmbreeFrames> embree_frames(const scene::Scene& scene, const EmbreeFrameOptions& options);

}  // namespace kdray::bench
