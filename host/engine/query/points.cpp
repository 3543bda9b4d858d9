#include "engine/query/points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "accel/prepare/instanced.h"
#include "base/error.h"
#include "engine/query/all_hits.h"
#include "engine/query/closest_point.h"
#include "engine/query/exact_scene.h"
#include "engine/query/grains.h"
#include "engine/query/pace.h"

namespace kdray::query {

namespace {

// Points of a chunk at most, and of the first one.
constexpr std::size_t kPointsAtOnce = std::size_t{1} << 18, kFirstPoints = std::size_t{1} << 12;

// Chunks of points as they can be asked for: those that are not finite are put at the origin, and remembered.
class PointChunks {
 public:
  PointChunks(const Points& points, const PointOptions& options) : points_(points), options_(&options) {}

  std::span<const dvec3> take(std::size_t first, std::size_t most) {
    throw_if_cancelled(options_->cancel);
    const std::size_t n = std::min(most, points_.size() - first);
    first_ = first;
    taken_.resize(n);
    invalid_.clear();
    for_each_index(n, [&](std::size_t i) {
      const auto p = points_[first + i];
      taken_[i] = {p[0], p[1], p[2]};
    });
    for (std::size_t i = 0; i < n; ++i)
      if (!is_finite(taken_[i])) leave_out(first, i);
    return taken_;
  }

  bool is_invalid(std::size_t i) const {
    return !invalid_.empty() && std::binary_search(invalid_.begin(), invalid_.end(), i);
  }
  // Of the chunk's point i, which is invalid.
  double signed_distance(std::size_t i) const {
    const auto p = points_[first_ + i];
    const bool is_number = std::none_of(p.begin(), p.end(), [](double x) { return std::isnan(x); });
    return is_number ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  }
  std::uint64_t n_invalid() const { return n_invalid_; }

 private:
  void leave_out(std::size_t first, std::size_t i) {
    if (options_->invalid == InvalidRays::error)
      throw Error(ErrorCode::input,
                  fmt::format("point {} is not finite; take it out or repair it", first + i));
    taken_[i] = dvec3(0);
    invalid_.push_back(i);
    ++n_invalid_;
  }

  Points points_;
  const PointOptions* options_;
  std::vector<dvec3> taken_;
  std::size_t first_ = 0;             // of the chunk in work
  std::vector<std::size_t> invalid_;  // of it, in order
  std::uint64_t n_invalid_ = 0;
};

// The way in which surfaces are counted. Any direction serves, since every crossing counts once; this one
// lies in no plane that models are likely to have faces in, which would cost time.
constexpr float kUp[3] = {0.1803f, 0.2741f, 1};

// How many surfaces each point has above it. Masks are for rays: points see every geometry.
std::vector<std::uint32_t> crossings_above(const QueryContext& context, std::span<const dvec3> points,
                                           const PointOptions& options) {
  std::vector<Ray> rays(points.size());
  for_each_index(points.size(), [&](std::size_t i) {
    const dvec3 local = context.frame.space().local(points[i]);
    const bool outside = context.frame.is_outside(local);
    const vec3 at = outside ? vec3(0) : vec3(local);
    const float end = std::numeric_limits<float>::infinity();
    rays[i] = {{at.x, at.y, at.z}, 0, {kUp[0], kUp[1], kUp[2]}, outside ? -end : end};
  });
  std::vector<std::uint32_t> counts(points.size());
  AllSessions& all = context.sessions;
  const bool masked = context.target.masks() != nullptr;
  count_hits(*(masked ? all.of_all : all.crossings).borrow(), rays, {.cancel = options.cancel}, counts);
  return counts;
}

// Whether each point has an odd number of surfaces above it: it is inside of closed ones. Points of doubles
// so near to a surface that floats can't tell are looked at in double.
std::vector<std::uint8_t> are_inside(const QueryContext& context, std::span<const dvec3> points,
                                     bool in_double, const PointOptions& options) {
  const std::vector<std::uint32_t> counts = crossings_above(context, points, options);
  std::vector<std::uint8_t> inside(points.size());
  for_each_index(points.size(), [&](std::size_t i) { inside[i] = counts[i] % 2; });
  if (!in_double) return inside;
  const ExactScene exact(context.scene());
  for_each_slow_grain(points.size(), options.cancel, [&](std::size_t begin, std::size_t end) {
    std::vector<ExactHit> hits;
    for (std::size_t i = begin; i < end; ++i) {
      const dvec3 place = context.frame.space().local(points[i]);
      if (context.frame.is_outside(place) || !exact.is_near(place)) continue;
      exact.cross(place, dvec3(kUp[0], kUp[1], kUp[2]), hits);
      inside[i] = hits.size() % 2;
    }
  });
  return inside;
}

bool are_doubles(const Points& points) {
  return !points.empty() && points.first_of<const double>() != nullptr;
}

// What lies nearest to points: asked for when it is made, so that the device works at it meanwhile.
class Nearest {
 public:
  Nearest(const QueryContext& context, std::span<const dvec3> points, double radius)
      : found_(points.size(), kNoClosestPoint) {
    check_points(points, radius);
    if (points.empty() || context.scene().geometry.bounds.empty()) return;
    session_ = context.sessions.points.borrow();
    session_->start(points, radius);
  }

  const std::vector<ClosestPoint>& wait() {
    if (session_) session_->wait(found_);
    session_.reset();
    return found_;
  }

 private:
  std::vector<ClosestPoint> found_;
  Sessions<PointSession>::Borrowed session_;
};

template <class Take>
QueryReport for_each_chunk(const QueryContext& context, const Points& points, const PointOptions& options,
                           const Take& take) {
  PointChunks chunks(points, options);
  Pace pace(kFirstPoints, kPointsAtOnce, context.sessions.points_at_once);
  for (std::size_t first = 0; first < points.size();) {
    const std::span<const dvec3> some = chunks.take(first, pace.take());
    take(first, some, chunks);
    first += some.size();
    pace.done(some.size());
  }
  return {chunks.n_invalid()};
}

}  // namespace

QueryReport closest_points(const QueryContext& context, const Points& points, const ClosestPointsOut& out,
                           const PointOptions& options) {
  prepare::refuse_instances(context.scene(), "closest points");
  const std::size_t n = points.size();
  check_out(out.distance.size(), n, "distance");
  check_out(out.point.size(), n, "point");
  check_out(out.geometry.size(), n, "geometry");
  check_out(out.primitive.size(), n, "primitive");
  check_out(out.u.size(), n, "u");
  check_out(out.v.size(), n, "v");
  return for_each_chunk(
      context, points, options,
      [&](std::size_t first, std::span<const dvec3> some, const PointChunks& chunks) {
        Nearest nearest(context, some, options.radius);
        const std::vector<ClosestPoint>& found = nearest.wait();
        const auto fill = [&](const auto& column, const auto& value_of) {
          if (column.empty()) return;
          column.fill(first, some.size(), [&](std::size_t i) {
            return value_of(chunks.is_invalid(i - first) ? kNoClosestPoint : found[i - first]);
          });
        };
        const auto place_of = [&](const ClosestPoint& p) {
          return p.primitive < 0 ? GeometryTable::Place{kNoGeometry, kNoPrimitive}
                                 : context.table.of(static_cast<std::uint32_t>(p.primitive));
        };
        fill(out.distance, [](const ClosestPoint& p) { return std::array{p.distance}; });
        fill(out.point, [](const ClosestPoint& p) { return std::array{p.point.x, p.point.y, p.point.z}; });
        fill(out.geometry, [&](const ClosestPoint& p) { return std::array{place_of(p).geometry}; });
        fill(out.primitive, [&](const ClosestPoint& p) { return std::array{place_of(p).primitive}; });
        fill(out.u, [](const ClosestPoint& p) { return std::array{p.u}; });
        fill(out.v, [](const ClosestPoint& p) { return std::array{p.v}; });
      });
}

QueryReport inside(const QueryContext& context, const Points& points, const BytesOut& out,
                   const PointOptions& options) {
  check_out(out.size(), points.size(), "inside");
  return for_each_chunk(
      context, points, options,
      [&](std::size_t first, std::span<const dvec3> some, const PointChunks& chunks) {
        const std::vector<std::uint8_t> found = are_inside(context, some, are_doubles(points), options);
        if (out.empty()) return;
        out.fill(first, some.size(), [&](std::size_t i) {
          return std::array{std::uint8_t(chunks.is_invalid(i - first) ? 0 : found[i - first])};
        });
      });
}

QueryReport signed_distance(const QueryContext& context, const Points& points, const ValuesOut& out,
                            const PointOptions& options) {
  prepare::refuse_instances(context.scene(), "signed distances");
  check_out(out.size(), points.size(), "distance");
  return for_each_chunk(context, points, options,
                        [&](std::size_t first, std::span<const dvec3> some, const PointChunks& chunks) {
                          Nearest nearest(context, some, options.radius);
                          const std::vector<std::uint8_t> inside =
                              are_inside(context, some, are_doubles(points), options);
                          const std::vector<ClosestPoint>& found = nearest.wait();
                          if (out.empty()) return;
                          out.fill(first, some.size(), [&](std::size_t i) {
                            const std::size_t at = i - first;
                            if (chunks.is_invalid(at)) return std::array{chunks.signed_distance(at)};
                            return std::array{inside[at] ? -found[at].distance : found[at].distance};
                          });
                        });
}

}  // namespace kdray::query
