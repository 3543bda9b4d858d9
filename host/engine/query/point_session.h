// What    The closest point of the scene's surfaces to each of many points, and how far it is: a kernel with
//         its queue and buffers (queries.h), asked a chunk at a time; or all of it for one call.
// Shape   In the order of the points, in the world's space. Of primitives at the same distance it is the one
//         with the smallest number. u and v are weights of a triangle's second and third corner, as of hits:
//         exactly 0 or 1 where an edge or a corner is closest. Beyond the radius nothing is found: primitive
//         -1, distance infinite. Buffers grow with the largest chunk that is asked for.
// Errors  Against the primitives as the kernels have them, floats about the scene's centre, the distance is
//         right to 2^-40 of itself, or to 2^-98 of the scene's size where that is more; on a device that does
//         not compute in double to 2^-36, or to 2^-28 of the scene's size. A point is rounded
//         once, to a double about the scene's centre: within the scene's bounds not at all.
//         (docs/design/closest-point.md) ErrorCode::input for a point that is not finite, with its index, and
//         for a radius that is no number or below 0; ErrorCode::internal for a point whose walk failed;
//         device errors as everywhere.
// Memory  The points and answers of a chunk beside what is returned.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/box.h"
#include "base/vec.h"
#include "device/opencl/spare_queue.h"
#include "engine/query/device_array.h"
#include "engine/query/target.h"
#include "engine/wavefront/stage.h"
#include "layout/closest.layout.h"

namespace kdray::query {

// An order in which points that lie near each other follow each other: their walks meet the same nodes,
// which then lie in a near cache. Random points go up to twice as fast for it
// (docs/design/closest-point.md). Along a Z curve over 128^3 cells of the box; in a cell the order stays.
// Source: Morton, "A computer oriented geodetic data base and a new technique in file sequencing", IBM
// 1966.
class NearbyOrder {
 public:
  explicit NearbyOrder(const Box& box);

  // The cell of a place, by its number along the curve.
  std::uint32_t cell_of(const dvec3& place) const;

  // The places' indices, in order of these cells; valid until the next call.
  std::span<const std::uint32_t> sorted(std::span<const std::uint32_t> cells);

 private:
  dvec3 from_, cells_per_length_;
  std::vector<std::uint32_t> half_sorted_, sorted_;
};

struct ClosestPoint {
  double distance;
  dvec3 point;
  std::int32_t primitive;  // its number in file order, or -1
  double u, v;
};

// What there is where nothing lies within the radius.
inline constexpr ClosestPoint kNoClosestPoint{std::numeric_limits<double>::infinity(),
                                              dvec3(std::numeric_limits<double>::infinity()), -1, 0, 0};

struct ClosestPoints {
  std::vector<ClosestPoint> points;
  double seconds = 0;  // wall time of all, but for the compiling of the kernel
};

// The first of them that is not finite, or points.size().
std::size_t first_not_finite(std::span<const dvec3> points);

// ErrorCode::input for a point that is not finite, with its index, and for a radius that is no number or
// below 0.
void check_points(std::span<const dvec3> points, double radius);

ClosestPoints closest_points(const Target& target, std::span<const dvec3> points, double radius);

inline constexpr double kPointReach = double{KDRAY_POINT_REACH};

// A point is asked from its own place in the scene's own space. One that is over 2^25 times the scene's size
// away is moved towards the scene until it isn't: what is closest stays so, but for 2^-50 of the distance.
struct Places {
  const LocalSpace& space;

  bool is_moved(const dvec3& point) const { return is_far(local_of(point)); }

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
