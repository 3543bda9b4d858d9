// What    Whole frames by Embree, for NFF's model (docs/scenes.md): eye rays, shadow rays to each point
//         light, reflection, refraction.
// Shape   A tile of 16 x 16 pixels at a time, generation by generation; all rays in packets of 16, eye and
//         shadow rays flagged as coherent, shadow rays light by light. Tiles are dealt out by TBB. Fast
//         scenes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scene/model/scene.h"

namespace kdray::bench {

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
