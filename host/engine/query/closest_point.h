// What    The closest point of the scene's surfaces to each of many points, and how far it is.
// Shape   In the order of the points, in the world's space. Of primitives at the same distance it is the one
//         with the smallest number. u and v are weights of a triangle's second and third corner, as of hits:
//         exactly 0 or 1 where an edge or a corner is closest. Of what lies beyond the radius nothing is
//         found: primitive -1, distance infinite.
// Errors  Against the primitives as the kernels have them, floats about the scene's centre, the distance is
//         right to 2^-40 of itself, or to 2^-98 of the scene's size where that is more; on a device that does
//         not compute in double to 2^-36, or to 2^-28 of the scene's size. A point is rounded
//         once, to a double about the scene's centre: within the scene's bounds not at all.
//         (docs/design/closest-point.md) ErrorCode::input for a point that is not finite, with its index, and
//         for a radius that is no number or below 0.
// Memory  The points and answers of a chunk beside what is returned.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/vec.h"
#include "engine/query/target.h"

namespace kdray::query {

struct ClosestPoint {
  double distance;
  dvec3 point;
  std::int32_t primitive;  // its number in file order, or -1
  float u, v;
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

// Kernel and buffers for it (point_session.h), of a scene that isn't empty. The points have been checked.
class PointSession;
void closest_points(PointSession& session, std::span<const dvec3> points, double radius,
                    std::span<ClosestPoint> answers);

ClosestPoints closest_points(const Target& target, std::span<const dvec3> points, double radius);

}  // namespace kdray::query
