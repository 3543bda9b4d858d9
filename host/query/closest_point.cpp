#include "query/closest_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/timer.h"
#include "device/opencl_error.h"
#include "device/spare_queue.h"
#include "layout/closest.layout.h"
#include "math/rounding.h"
#include "query/grains.h"
#include "query/nearby_order.h"
#include "wavefront/stage.h"

namespace kdray::query {

namespace {

using layout::ClosestHit;
using layout::QueryPoint;

// Points in one launch: 38 MiB with their answers; for a GPU enough to fill it.
constexpr std::size_t kPointsPerChunk = std::size_t{1} << 19;

constexpr double kPointReach = double{KDRAY_POINT_REACH};

// What    a point is asked from: itself in the scene's own space. A point that is over 2^25 times the scene's
//         size away is
// moved towards the scene until it isn't: what is closest stays so, but for 2^-50 of the distance.
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

QueryPoint packed(const dvec3& place) {
  return {{std::bit_cast<layout::u64>(place.x), std::bit_cast<layout::u64>(place.y),
           std::bit_cast<layout::u64>(place.z)}};
}

double number_of(layout::u64 bits, layout::u32 form) {
  if (form == KDRAY_FORM_DOUBLE) return std::bit_cast<double>(bits);
  return double{std::bit_cast<float>(static_cast<layout::u32>(bits))} +
         double{std::bit_cast<float>(static_cast<layout::u32>(bits >> 32))};
}

ClosestPoint answer_of(const Places& places, const dvec3& point, const ClosestHit& hit, double radius) {
  if (hit.number < 0) return kNoClosestPoint;
  const dvec3 local(number_of(hit.point[0], hit.form), number_of(hit.point[1], hit.form),
                    number_of(hit.point[2], hit.form));
  const double distance = places.distance(point, local, number_of(hit.distance, hit.form));
  if (distance > radius) return kNoClosestPoint;
  return {distance, places.space.world(local), hit.number, hit.u, hit.v};
}

void check_points(std::span<const dvec3> points, double radius) {
  if (!(radius >= 0))
    throw Error(ErrorCode::input, fmt::format("a radius of {}: it must be 0 or more, or infinite", radius));
  const std::size_t bad = first_not_finite(points);
  if (bad < points.size())
    throw Error(ErrorCode::input, fmt::format("point {}: it is not finite; take it out or repair it", bad));
}

cl_float4 corner_of_bounds(const vec3& v) {
  return cl_float4{{v.x, v.y, v.z, 0}};
}

// In local lengths, rounded up; beyond all floats: without end.
float reach_of(const LocalSpace& space, double radius) {
  const double local = space.local_length(radius);
  return local < kPointReach ? round_up(local) : std::numeric_limits<float>::max();
}

class Asking {
 public:
  Asking(const Target& target, double radius, std::size_t chunk)
      : target_(target),
        places_{target.scene.geometry.space},
        radius_(radius),
        stage_(target.programs.kernel<K>(target.scene.features, Traversal::wide)),
        spare_(target.context),
        queue_(spare_.get()),
        order_(target.scene.geometry.bounds),
        queries_(chunk),
        hits_(chunk),
        in_(target.context.buffer(CL_MEM_READ_ONLY, chunk * sizeof(QueryPoint), "the points")),
        out_(target.context.buffer(CL_MEM_WRITE_ONLY, chunk * sizeof(ClosestHit), "the closest points")) {
    const scene::Geometry& geometry = target.scene.geometry;
    target.buffers.set_arguments(stage_);
    stage_.set(K::root_lo, corner_of_bounds(geometry.bounds.lo))
        .set(K::root_hi, corner_of_bounds(geometry.bounds.hi));
    stage_.set(K::reach, reach_of(geometry.space, radius)).set(K::points, in_).set(K::closest, out_);
    // PoCL compiles a kernel for good at its first launch.
    const device::AtWork compiling(target.context.builds());
    stage_.set(K::n_points, cl_uint{0});
    launch(chunk);
  }

  void ask(std::span<const dvec3> points, std::span<ClosestPoint> answers) {
    const std::size_t n = points.size();
    const std::span<const std::uint32_t> order = put_in_order(points);
    queue_.enqueueWriteBuffer(in_, CL_TRUE, 0, n * sizeof(QueryPoint), queries_.data());
    stage_.set(K::n_points, static_cast<cl_uint>(n));
    launch(n);
    queue_.enqueueReadBuffer(out_, CL_TRUE, 0, n * sizeof(ClosestHit), hits_.data());
    std::atomic<bool> invalid = false;
    for_each_index(n, [&](std::size_t i) {
      if (hits_[i].number == KDRAY_CLOSEST_INVALID) invalid = true;
      answers[order[i]] = answer_of(places_, points[order[i]], hits_[i], radius_);
    });
    if (invalid)
      throw Error(ErrorCode::internal,
                  "a point came to a kind of primitive that its program lacks; please report it");
  }

 private:
  using K = kernels::ClosestPoints;

  // Makes the queries, and tells which points they are of.
  std::span<const std::uint32_t> put_in_order(std::span<const dvec3> points) {
    cells_.resize(points.size());
    for_each_index(points.size(),
                   [&](std::size_t i) { cells_[i] = order_.cell_of(places_.place_of(points[i])); });
    const std::span<const std::uint32_t> order = order_.sorted(cells_);
    for_each_index(points.size(),
                   [&](std::size_t i) { queries_[i] = packed(places_.place_of(points[order[i]])); });
    return order;
  }

  void launch(std::size_t n) {
    stage_.launch(queue_, n, target_.work_group);
    queue_.finish();
  }

  const Target& target_;
  Places places_;
  double radius_;
  wavefront::Stage<K> stage_;
  device::SpareQueue spare_;
  cl::CommandQueue queue_;
  NearbyOrder order_;
  std::vector<std::uint32_t> cells_;
  std::vector<QueryPoint> queries_;
  std::vector<ClosestHit> hits_;
  cl::Buffer in_, out_;
};

}  // namespace

std::size_t first_not_finite(std::span<const dvec3> points) {
  const auto bad = std::find_if(points.begin(), points.end(), [](const dvec3& p) { return !is_finite(p); });
  return static_cast<std::size_t>(bad - points.begin());
}

ClosestPoints closest_points(const Target& target, std::span<const dvec3> points, double radius) {
  check_points(points, radius);
  ClosestPoints result{std::vector<ClosestPoint>(points.size(), kNoClosestPoint)};
  if (points.empty() || target.scene.geometry.bounds.empty()) return result;
  const std::size_t chunk = std::min(points.size(), kPointsPerChunk);
  device::checked("finding closest points", [&] {
    Asking asking(target, radius, chunk);
    const Timer timer;
    for (std::size_t first = 0; first < points.size(); first += chunk) {
      const std::size_t n = std::min(chunk, points.size() - first);
      asking.ask(points.subspan(first, n), std::span(result.points).subspan(first, n));
    }
    result.seconds = timer.seconds();
  });
  return result;
}

}  // namespace kdray::query
