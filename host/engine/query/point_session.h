// What    A kernel with its queue and buffers, ready to find closest points (sessions.h), a chunk at a time.
// Shape   Buffers grow with the largest chunk that is asked for.
// Errors  ErrorCode::internal for a point whose walk failed; device errors as everywhere.
#pragma once

#include <span>
#include <vector>

#include "device/opencl/spare_queue.h"
#include "engine/query/closest_point.h"
#include "engine/query/device_array.h"
#include "engine/query/nearby_order.h"
#include "engine/query/target.h"
#include "engine/wavefront/stage.h"
#include "layout/closest.layout.h"

namespace kdray::query {

inline constexpr double kPointReach = double{KDRAY_POINT_REACH};

// A point is asked from its own place in the scene's own space. One that is over 2^25 times the scene's size
// away is moved towards the scene until it isn't: what is closest stays so, but for 2^-50 of the distance.
struct Places {
  const LocalSpace& space;

  dvec3 place_of(const dvec3& point) const {
    const dvec3 local = local_of(point);
    return is_far(local) ? safe_normalize(half_way(point)) * kPointReach : local;
  }

  // Of a far point, whose place was another, from the point itself.
  double distance(const dvec3& point, const dvec3& closest, double local) const {
    if (!is_far(local_of(point))) return space.world_length(local);
    return 2 * safe_length(half_way(point) - 0.5 * (closest / space.scale));
  }

 private:
  static bool is_far(const dvec3& local) { return !(largest_component(local) <= kPointReach); }

  // The difference of the largest doubles isn't one, that of their halves is.
  dvec3 half_way(const dvec3& point) const { return 0.5 * point - 0.5 * space.center; }

  dvec3 local_of(const dvec3& point) const {
    const dvec3 from_center = point - space.center;
    return is_finite(from_center) ? from_center * space.scale : half_way(point) * (2 * space.scale);
  }
};

class PointSession {
 public:
  explicit PointSession(const Target& target);
  bool settle() noexcept { return clFinish(queue_.get()()) == CL_SUCCESS; }

  // Starts to find what is closest to these points, which have to stay. They are finite, and the radius is 0
  // or more; no more than 2^31 points at a time.
  void start(std::span<const dvec3> points, double radius);
  // The answers to what was started.
  void wait(std::span<ClosestPoint> answers);

 private:
  using K = kernels::ClosestPoints;

  void reserve(std::size_t n);
  std::span<const std::uint32_t> put_in_order(std::span<const dvec3> points);
  void launch(std::size_t n);

  const Target& target_;
  Places places_;
  wavefront::Stage<K> stage_;
  device::SpareQueue queue_;
  NearbyOrder order_;
  std::vector<std::uint32_t> cells_;
  DeviceArray<layout::QueryPoint> queries_;
  DeviceArray<layout::ClosestHit> hits_;
  // What was started.
  std::span<const dvec3> points_;
  std::span<const std::uint32_t> points_order_;  // of which points the queries are; empty: in their own order
  double radius_ = 0;
};

}  // namespace kdray::query
