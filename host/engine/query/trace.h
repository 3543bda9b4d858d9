// What    Traces rays so that the launches alone are timed (kdray trace, benches): closest hits or occlusion,
//         in chunks that fit the devices, each of which has the rays before the time counts.
// Shape   Each of several targets takes a part of a chunk that its compute units have a share in.
// Errors  ErrorCode::input for a ray that is not one (check_rays.h); the message has the ray's number.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/target.h"
#include "kdray/ray.h"

namespace kdray::query {

struct TraceOptions {
  bool any_hit = false;
  int repeat = 1;
};

struct Traced {
  std::vector<Hit> hits;
  // Of closest hits, where the scene has instances, the place in its list of the one that each lies in, or
  // kNoInstance; else nothing. The hit's primitive is the mesh's.
  std::vector<std::uint32_t> instances;
  std::vector<double> seconds;  // wall time of each repetition, rays already on the device
};

// `targets` are of one scene.
Traced trace(std::span<const Target> targets, std::span<const Ray> rays, const TraceOptions& options);
Traced trace(const Target& target, std::span<const Ray> rays, const TraceOptions& options);

}  // namespace kdray::query
