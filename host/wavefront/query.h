// What    Traces rays from outside (kdray trace): closest hits or occlusion, in chunks that fit the device.
// Errors  ErrorCode::input for a ray that is not one: NaN anywhere, an infinite origin or t_min, a direction
//         that is infinite or 0; the message has the ray's number.
#pragma once

#include <span>
#include <vector>

#include "kdray/options.h"
#include "kdray/ray.h"
#include "scene/geometry.h"
#include "wavefront/programs.h"
#include "wavefront/scene_buffers.h"

namespace kdray::wavefront {

// Rays in one launch: 512 MiB of them; and for a GPU, whose watchdog may end what takes seconds.
constexpr std::size_t kRaysPerChunk = std::size_t{1} << 24, kBoundedLaunch = std::size_t{1} << 20;

struct QueryResult {
  std::vector<Hit> hits;
  std::vector<double> seconds;  // wall time of each repetition, rays already on the device
};

QueryResult trace_query(const device::Context& context, const SceneBuffers& scene, Programs& programs,
                        const scene::Geometry& geometry, layout::Features features, std::size_t work_group,
                        Traversal traversal, Precision precision, std::span<const Ray> rays, bool any_hit,
                        int repeat, std::size_t rays_per_launch = kRaysPerChunk);

}  // namespace kdray::wavefront
