// What    Traces rays from outside (kdray trace): closest hits or occlusion, in chunks that fit the device.
// Errors  ErrorCode::input for a ray that is not one (check_rays.h); the message has the ray's number.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/target.h"
#include "kdray/options.h"
#include "kdray/ray.h"

namespace kdray::query {

struct TraceOptions {
  bool any_hit = false;
  Traversal traversal = Traversal::automatic;  // on a target that is global: binary or wide
  Precision precision = Precision::float32;
  int repeat = 1;
};

struct Traced {
  std::vector<Hit> hits;
  // Of closest hits, where the scene has instances, the place in its list of the one that each lies in, or
  // kNoInstance; else nothing. The hit's primitive is the mesh's.
  std::vector<std::uint32_t> instances;
  std::vector<double> seconds;  // wall time of each repetition, rays already on the device
};

Traced trace(const Target& target, std::span<const Ray> rays, const TraceOptions& options);

}  // namespace kdray::query
