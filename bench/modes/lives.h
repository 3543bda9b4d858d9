// What    A sample of a frame's rays with their whole lives: the eye rays of a picture of fewer pixels, and
//         what each leads to, down to the frame's depth: shadow rays to every light, reflected and refracted
//         rays where the material has them.
// Shape   Level by level, parents before children; a ray ends at what it hits. Shadow rays end at the first
//         thing in their way, since that is where a walk from cell to cell ends.
// Why     The rays are not the frame's own, which never leave the device, but are made by its rules. Normals
//         are those of the surfaces (not interpolated), and a cone of light is taken for a sphere:
//         model.h holds their numbers against the frame's.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/workload/rays.h"

namespace kdray::bench {

enum class LifeKind : std::uint8_t { primary, shadow, reflected, refracted };

inline constexpr std::uint32_t kNoParent = ~0u;

struct LifeRay {
  Ray ray{};  // t_max is where it ends
  std::uint32_t parent = kNoParent;
  std::uint8_t depth = 1;  // a shadow ray has that of the ray it comes from
  LifeKind kind = LifeKind::primary;
  bool hit = false;
};

// Whether what it meets is shaded there.
inline bool is_shaded(const LifeRay& life) {
  return life.hit && life.kind != LifeKind::shadow;
}

struct LifeOptions {
  int width = 128, height = 128;  // eye rays across and down
  int depth = 5;
  double least_weight = 0;  // rays of less are not spawned
};

std::vector<LifeRay> make_lives(const scene::Scene& scene, const LifeOptions& options, const Tracer& trace);

}  // namespace kdray::bench
