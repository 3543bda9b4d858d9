// What    What a program asks of a scene with rays and points, and where the answers go.
// Shape   Views of the caller's arrays (arrays.h). Rays are float or double, every array by itself; with one
//         of doubles they are rays of doubles. An answer that isn't wanted is an empty view, and is not
//         computed.
// Units   The scene's; t counts in multiples of the direction as it was given.
// Errors  kdray::Error: ErrorCode::input for sizes that don't match and, unless InvalidRays::miss says
//         otherwise, for an invalid ray (NaN anywhere, an infinite origin, t_min = inf, a direction that is
//         infinite or 0), with its number; ErrorCode::cancelled.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "kdray/arrays.h"
#include "kdray/cancel.h"
#include "kdray/model.h"
#include "kdray/ray.h"

namespace kdray {

// The rays origin + t*direction, t_min < t < t_max (Scene::count says of t = 0). What has one row is the same
// for all rays.
struct Rays {
  Points origins, directions;
  Values t_min = {}, t_max = {};  // empty: 0 and infinity
  Words masks = {};               // empty: every bit

  // Rays as they lie in an array of the struct.
  static Rays of(std::span<const Ray> rays) {
    if (rays.empty()) return {};
    constexpr std::size_t kStride = sizeof(Ray);
    return {{rays.front().origin, rays.size(), kStride},
            {rays.front().direction, rays.size(), kStride},
            {&rays.front().t_min, rays.size(), kStride},
            {&rays.front().t_max, rays.size(), kStride},
            {}};
  }
};

// Of each ray what it hits first; of several at one distance the one that comes first in the scene. A miss
// has u, v and normal 0, and a point at infinity.
struct HitsOut {
  ValuesOut t = {};         // infinity: a miss
  WordsOut geometry = {};   // kNoGeometry: a miss
  WordsOut primitive = {};  // of the geometry, from 0; kNoPrimitive: a miss
  // Triangles: weights of the second and third corner; cones: u from base to apex.
  ValuesOut u = {}, v = {};
  // Of unit length, of the surface as it is (no vertex normals): of a triangle to the side from which its
  // corners run counterclockwise (in a mirrored instance: in the prototype), of a sphere outward, of a cone
  // away from its axis.
  PointsOut normal = {};
  PointsOut point = {};  // origin + t*direction
  // Of the geometry, from 0, where that is instances; kNoInstance: a miss, or what is none. The primitive is
  // the prototype's.
  WordsOut instance = {};
};

enum class InvalidRays { error, miss };

struct QueryOptions {
  InvalidRays invalid = InvalidRays::error;
  std::optional<Cancel> cancel = {};
};

struct QueryReport {
  std::uint64_t invalid = 0;  // invalid rays or points, which counted as misses
};

// All hits of rays: those of ray i are [splits[i], splits[i + 1]), sorted by t and, where that is equal, by
// their order in the scene, in which instances come behind all else.
struct AllHits {
  std::vector<std::uint64_t> splits;  // one more than rays
  std::vector<double> t;
  std::vector<std::uint32_t> geometry, primitive;
  std::vector<float> u, v;
  std::vector<std::uint8_t> more;       // of each ray, 1: it has more than max_hits
  std::vector<std::uint32_t> instance;  // as HitsOut
  QueryReport report;
};

struct AllHitsOptions : QueryOptions {
  std::uint32_t max_hits = 0xffffffffu;  // of a ray: the first so many
  // That all hits of all rays may take: where they take more, ErrorCode::out_of_memory, which says how many
  // there were by then. 0: what memory is free.
  std::uint64_t max_bytes = 0;
};

// Of each point what lies nearest to it; of several at one distance the one that comes first in the scene.
// Triangles of which two corners are the same floats are left out.
struct ClosestPointsOut {
  ValuesOut distance = {};  // infinity: nothing lies within the radius
  PointsOut point = {};
  WordsOut geometry = {}, primitive = {};  // as HitsOut
  ValuesOut u = {}, v = {};
  WordsOut instance = {};  // as HitsOut
};

// Masks are for rays: points see every geometry, and so do pictures.
struct PointOptions {
  double radius = std::numeric_limits<double>::infinity();  // how far to look
  // A point that is not finite: an error that names it, or one that has nothing near it, and is inside of
  // nothing; its signed distance is infinity, or NaN where it has NaN.
  InvalidRays invalid = InvalidRays::error;
  std::optional<Cancel> cancel = {};
};

}  // namespace kdray
