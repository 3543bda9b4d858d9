#include "engine/query/point_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "base/timer.h"
#include "device/opencl/opencl_error.h"
#include "engine/query/grains.h"

namespace kdray::query {

namespace {

constexpr int kBits = 7;  // of a cell's place along an axis
constexpr double kCells = 1 << kBits;

// The sort goes over the low and the high half of a cell's number.
constexpr int kHalf = (3 * kBits + 1) / 2;
constexpr std::size_t kBuckets = std::size_t{1} << kHalf;

// Each bit three places from the next.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

// Moves the indices into buckets by a half of their cells' numbers, in the order that they come in.
template <class IndexAt>
void sort_by_half(std::span<const std::uint32_t> cells, int shift, const IndexAt& index_at,
                  std::vector<std::uint32_t>& out) {
  std::array<std::uint32_t, kBuckets> next{};
  const auto bucket = [&](std::uint32_t index) { return cells[index] >> shift & (kBuckets - 1); };
  for (std::uint32_t i = 0; i < cells.size(); ++i) ++next[bucket(i)];
  std::uint32_t before = 0;
  for (std::uint32_t& n : next) n = std::exchange(before, before + n);
  out.resize(cells.size());
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    const std::uint32_t index = index_at(i);
    out[next[bucket(index)]++] = index;
  }
}

}  // namespace

NearbyOrder::NearbyOrder(const Box& box) : from_(box.lo) {
  const dvec3 extent = glm::max(dvec3(box.extent()), dvec3(std::numeric_limits<float>::min()));
  cells_per_length_ = kCells / extent;
}

std::uint32_t NearbyOrder::cell_of(const dvec3& place) const {
  const dvec3 at = glm::clamp((place - from_) * cells_per_length_, 0.0, kCells - 1);
  return spread(static_cast<std::uint32_t>(at.x)) | spread(static_cast<std::uint32_t>(at.y)) << 1 |
         spread(static_cast<std::uint32_t>(at.z)) << 2;
}

std::span<const std::uint32_t> NearbyOrder::sorted(std::span<const std::uint32_t> cells) {
  sort_by_half(
      cells, 0, [](std::uint32_t i) { return i; }, half_sorted_);
  sort_by_half(
      cells, kHalf, [this](std::uint32_t i) { return half_sorted_[i]; }, sorted_);
  return sorted_;
}

namespace {

// Points in one launch: 38 MiB with their answers; for a GPU enough to fill it.
constexpr std::size_t kPointsPerChunk = std::size_t{1} << 19;

}  // namespace

std::size_t first_not_finite(std::span<const dvec3> points) {
  const auto bad = std::find_if(points.begin(), points.end(), [](const dvec3& p) { return !is_finite(p); });
  return static_cast<std::size_t>(bad - points.begin());
}

void check_points(std::span<const dvec3> points, double radius) {
  if (!(radius >= 0))
    throw Error(ErrorCode::input, fmt::format("a radius of {}: it must be 0 or more, or infinite", radius));
  const std::size_t bad = first_not_finite(points);
  if (bad < points.size())
    throw Error(ErrorCode::input, fmt::format("point {}: it is not finite; take it out or repair it", bad));
}

void closest_points(PointSession& session, std::span<const dvec3> points, double radius,
                    std::span<ClosestPoint> answers) {
  for (std::size_t first = 0; first < points.size(); first += kPointsPerChunk) {
    const std::size_t n = std::min(kPointsPerChunk, points.size() - first);
    session.start(points.subspan(first, n), radius);
    session.wait(answers.subspan(first, n));
  }
}

ClosestPoints closest_points(const Target& target, std::span<const dvec3> points, double radius) {
  check_points(points, radius);
  ClosestPoints result{std::vector<ClosestPoint>(points.size(), kNoClosestPoint)};
  if (points.empty() || target.scene.geometry.bounds.empty()) return result;
  PointSession session(target);
  const Timer timer;
  closest_points(session, points, radius, result.points);
  result.seconds = timer.seconds();
  return result;
}

namespace {

using layout::ClosestHit;
using layout::QueryPoint;

// A launch has space for so many points at least.
constexpr std::size_t kLeastCapacity = 1024;
// Fewer are asked as they come: sorting them would take longer than they do.
constexpr std::size_t kFewPoints = 64;

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

cl_float4 corner_of_bounds(const vec3& v) {
  return cl_float4{{v.x, v.y, v.z, 0}};
}

// In local lengths, rounded up; beyond all floats: without end.
float reach_of(const LocalSpace& space, double radius) {
  const double local = space.local_length(radius);
  return local < kPointReach ? round_up(local) : std::numeric_limits<float>::max();
}

}  // namespace

PointSession::PointSession(const Target& target)
    : target_(target),
      places_{target.scene.geometry.space},
      stage_(target.programs.kernel<K>(target.scene.features, Traversal::wide)),
      queue_(target.context, target.sub_device),
      order_(target.scene.geometry.bounds) {
  const Box& bounds = target.scene.geometry.bounds;
  device::checked("getting ready to find closest points", [&] {
    target.buffers.set_arguments(stage_);
    stage_.set(K::root_lo, corner_of_bounds(bounds.lo)).set(K::root_hi, corner_of_bounds(bounds.hi));
    reserve(kLeastCapacity);
    // PoCL compiles a kernel for good at its first launch.
    const device::AtWork compiling(target.context.builds());
    stage_.set(K::n_points, cl_uint{0}).set(K::reach, 0.0f);
    launch(1);
    queue_.get().finish();
    stage_.forget_launches();
  });
}

void PointSession::reserve(std::size_t n) {
  if (n <= queries_.size()) return;
  n = std::bit_ceil(n);
  queries_ = {target_.context, CL_MEM_READ_ONLY, n, "the points"};
  hits_ = {target_.context, CL_MEM_WRITE_ONLY, n, "the closest points"};
  stage_.set(K::points, queries_.buffer()).set(K::closest, hits_.buffer());
}

void PointSession::start(std::span<const dvec3> points, double radius) {
  points_ = points;
  radius_ = radius;
  device::checked("finding closest points", [&] {
    reserve(points.size());
    points_order_ = put_in_order(points);
    queries_.send(queue_.get(), points.size());
    stage_.set(K::n_points, static_cast<cl_uint>(points.size()));
    stage_.set(K::reach, reach_of(places_.space, radius));
    launch(points.size());
    queue_.get().flush();
  });
}

void PointSession::wait(std::span<ClosestPoint> answers) {
  device::checked("finding closest points", [&] {
    queue_.get().finish();
    stage_.forget_launches();
    hits_.fetch(queue_.get(), points_.size());
  });
  const ClosestHit* const hits = hits_.data();
  std::atomic<bool> failed{false};
  for_each_grain(points_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (hits[i].number == KDRAY_CLOSEST_INVALID) failed = true;
      const std::size_t at = points_order_.empty() ? i : points_order_[i];
      answers[at] = answer_of(places_, points_[at], hits[i], radius_);
    }
  });
  if (failed)
    throw Error(ErrorCode::internal,
                "a point came to a kind of primitive that its program lacks; please report it");
}

// Makes the queries, and tells which points they are of; empty: the same.
std::span<const std::uint32_t> PointSession::put_in_order(std::span<const dvec3> points) {
  const auto for_all = [&](const auto& work) {
    for_each_grain(points.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) work(i);
    });
  };
  QueryPoint* const queries = queries_.data();
  if (points.size() < kFewPoints) {
    for_all([&](std::size_t i) { queries[i] = packed(places_.place_of(points[i])); });
    return {};
  }
  cells_.resize(points.size());
  for_all([&](std::size_t i) { cells_[i] = order_.cell_of(places_.place_of(points[i])); });
  const std::span<const std::uint32_t> order = order_.sorted(cells_);
  for_all([&](std::size_t i) { queries[i] = packed(places_.place_of(points[order[i]])); });
  return order;
}

void PointSession::launch(std::size_t n) {
  stage_.launch(queue_.get(), n, target_.work_group);
}

}  // namespace kdray::query
