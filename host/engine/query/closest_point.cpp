#include "engine/query/closest_point.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/timer.h"
#include "engine/query/point_session.h"

namespace kdray::query {

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

}  // namespace kdray::query
