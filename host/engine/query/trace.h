// What    Traces rays so that the launches alone are timed (kdray trace, benches): closest hits or occlusion,
//         in chunks that fit the devices, each of which has the rays before the time counts.
// Shape   Each of several targets takes a part of a chunk that its compute units have a share in.
// Errors  ErrorCode::input for a ray that is not one (check_rays.h); the message has the ray's number.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "device/opencl/spare_queue.h"
#include "engine/query/device_array.h"
#include "engine/query/target.h"
#include "engine/wavefront/stage.h"
#include "kdray/ray.h"
#include "layout/rays.layout.h"

namespace kdray::query {

// A hit's primitive where the walk failed, and where a scene of doubles leaves it in doubt:
// KDRAY_QUERY_INVALID and KDRAY_QUERY_IN_DOUBT of query.clh.
inline constexpr std::int32_t kFailedWalk = -2, kInDoubt = -3;
[[noreturn]] void throw_failed_walk();

// Kernels with their queue and buffers, ready to trace a chunk of rays (queries.h): closest hits or
// any hits. Chunks are so small that rays and hits stay in a cache between host and kernel, and so large
// that a launch is of no account; a GPU's are larger. A chunk is started, and waited for later: two
// sessions keep a device busy while the host gets one's rays ready and takes the other's hits. Who times
// launches alone (trace) loads, launches and finishes by itself. Errors: ErrorCode::internal for a ray
// whose walk failed; device errors as everywhere.
class Session {
 public:
  explicit Session(const Target& target) : Session(target, usual_chunk(target)) {}
  // For chunks of at most so many rays.
  Session(const Target& target, std::size_t chunk);

  // PoCL compiles a kernel for good at its first launch: here at one of as many work-items that finds no
  // rays. Memory that nobody has written to yet is handed out page by page, which is no part of tracing.
  void warm_up(std::size_t n);

  bool settle() noexcept;
  std::size_t chunk() const { return rays_.size(); }

  // Where the rays of a chunk, in the scene's own space, and their masks are to be put.
  layout::QueryRay* rays() { return rays_.data(); }
  std::uint32_t* ray_masks() { return masks_.data(); }

  // Starts to trace the first n. Of a hit `primitive` is its number, or with `as_refs` its reference
  // (tree.layout.h); t is in the scene's own space.
  void start(std::size_t n, bool any_hit, bool as_refs) {
    load(n, any_hit, as_refs);
    launch();
  }
  // The same in steps: the first n on the device; traced, which may be repeated; and at its end.
  void load(std::size_t n, bool any_hit, bool as_refs);
  void launch();
  void finish();
  // The hits of what was started, valid until the next start. Whoever takes them looks for kFailedWalk.
  std::span<const layout::QueryHit> wait();
  // Of each of these hits, where the scene has instances, the index of the one that it lies in, or
  // kNoInstance; else nothing.
  std::span<const std::uint32_t> instances() const { return instances_.first(placed_ ? n_started_ : 0); }

 private:
  static std::size_t usual_chunk(const Target& target);
  void enqueue(std::size_t n, std::size_t n_items);

  bool started_ = false;
  bool masked_;  // primitives have masks
  bool placed_;  // there are instances
  device::SpareQueue queue_;
  wavefront::Stage<kernels::TraceQuery> stage_;
  std::size_t work_group_;
  bool chunked_;
  DeviceArray<layout::QueryRay> rays_;
  DeviceArray<layout::QueryHit> hits_;
  DeviceArray<std::uint32_t> masks_, instances_;
  std::size_t n_started_ = 0;
};

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
