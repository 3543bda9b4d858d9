#include "engine/query/queries.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "accel/prepare/instanced.h"
#include "base/error.h"
#include "engine/query/all_hits.h"
#include "engine/query/double_scene.h"
#include "engine/query/exact_scene.h"
#include "engine/query/grains.h"
#include "engine/query/point_session.h"
#include "engine/query/shared_rows.h"
#include "engine/query/surface.h"

namespace kdray::query {

namespace {

// Points of a chunk at most, and of the first one.
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kPointsAtOnce = std::size_t{1} << 18, kFirstPoints = std::size_t{1} << 12;

// Chunks of points as they can be asked for: those that are not finite are put at the origin, and remembered.
class PointChunks {
 public:
  PointChunks(const Points& points, const PointOptions& options) : points_(points), options_(&options) {}

  std::span<const dvec3> take(std::size_t first, std::size_t n) {
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
std::vector<std::uint32_t> crossings_above(const QueryContext& context, Place& place,
                                           std::span<const dvec3> points,
                                           const std::optional<Cancel>& cancel) {
  std::vector<Ray> rays(points.size());
  for_each_index(points.size(), [&](std::size_t i) {
    const dvec3 local = context.frame.space().local(points[i]);
    const bool outside = context.frame.is_outside(local);
    const vec3 at = outside ? vec3(0) : vec3(local);
    const float end = std::numeric_limits<float>::infinity();
    rays[i] = {{at.x, at.y, at.z}, 0, {kUp[0], kUp[1], kUp[2]}, outside ? -end : end};
  });
  std::vector<std::uint32_t> counts(points.size());
  AllSessions& all = place.sessions;
  count_hits(*(context.has_masks() ? all.of_all : all.crossings).borrow(), rays, {.cancel = cancel}, counts);
  return counts;
}

// The same in a scene of doubles: of what the filter leaves in doubt, or of all, the host counts.
std::vector<std::uint32_t> crossings_above_in_doubles(const QueryContext& context, Place& place,
                                                      std::span<const dvec3> points,
                                                      const std::optional<Cancel>& cancel) {
  std::vector<std::uint32_t> counts(points.size(), kInDoubtCount);
  if (place.target.filters) counts = crossings_above(context, place, points, cancel);
  const DoubleScene scene(context.scene());
  const dvec3 up(kUp[0], kUp[1], kUp[2]);
  for_each_slow_grain(points.size(), cancel, [&](std::size_t begin, std::size_t end) {
    std::vector<DoubleScene::Question> in_doubt;
    for (std::size_t i = begin; i < end; ++i) {
      if (counts[i] != kInDoubtCount) continue;
      counts[i] = 0;
      if (context.frame.is_outside(context.frame.space().local(points[i]))) continue;
      if (const auto ray = context.frame.double_ray(points[i], up, 0, kInfinity))
        in_doubt.push_back({*ray, ~0u, i});
    }
    scene.count(in_doubt, counts);
  });
  return counts;
}

// Whether each point has an odd number of surfaces above it: it is inside of closed ones. Points of doubles
// so near to a surface that floats can't tell are looked at in double.
std::vector<std::uint8_t> are_inside(const QueryContext& context, Place& place, std::span<const dvec3> points,
                                     bool in_double, const std::optional<Cancel>& cancel) {
  const bool of_doubles = context.scene().doubles != nullptr;
  const std::vector<std::uint32_t> counts = of_doubles
                                                ? crossings_above_in_doubles(context, place, points, cancel)
                                                : crossings_above(context, place, points, cancel);
  std::vector<std::uint8_t> inside(points.size());
  for_each_index(points.size(), [&](std::size_t i) { inside[i] = counts[i] % 2; });
  if (!in_double || of_doubles) return inside;
  const ExactScene exact(context.scene());
  for_each_slow_grain(points.size(), cancel, [&](std::size_t begin, std::size_t end) {
    std::vector<ExactHit> hits;
    for (std::size_t i = begin; i < end; ++i) {
      const dvec3 local = context.frame.space().local(points[i]);
      if (context.frame.is_outside(local) || !exact.is_near(local)) continue;
      exact.cross(local, dvec3(kUp[0], kUp[1], kUp[2]), HUGE_VAL, hits);
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
  Nearest(const QueryContext& context, Place& place, std::span<const dvec3> points, double radius)
      : found_(points.size(), kNoClosestPoint) {
    check_points(points, radius);
    if (points.empty() || context.scene().geometry.bounds.empty()) return;
    if (context.scene().doubles) {
      look_up_doubles(context, points, radius);
      return;
    }
    session_ = place.sessions.points.borrow();
    session_->start(points, radius);
  }

  const std::vector<ClosestPoint>& wait() {
    if (session_) session_->wait(found_);
    session_.reset();
    return found_;
  }

 private:
  void look_up_doubles(const QueryContext& context, std::span<const dvec3> points, double radius) {
    const DoubleScene scene(context.scene());
    const LocalSpace& space = context.frame.space();
    const Places places{space};
    // Many are looked up one near the other, for the caches.
    constexpr std::size_t kMany = std::size_t{1} << 10;
    NearbyOrder order(context.scene().geometry.bounds);
    std::vector<std::uint32_t> cells(points.size() < kMany ? 0 : points.size());
    for_each_index(cells.size(),
                   [&](std::size_t i) { cells[i] = order.cell_of(places.place_of(points[i])); });
    std::span<const std::uint32_t> in_order;
    if (!cells.empty()) in_order = order.sorted(cells);
    for_each_slow_grain(points.size(), std::nullopt, [&](std::size_t begin, std::size_t end) {
      std::optional<dvec3> before;  // what the last one found
      for (std::size_t at = begin; at < end; ++at) {
        const std::size_t i = in_order.empty() ? at : in_order[at];
        const dvec3 place = places.place_of(points[i]);
        constexpr double kMore = 1 + 0x1p-40;
        const double most = places.is_moved(points[i]) ? kInfinity : kMore * space.local_length(radius);
        const double near = before ? kMore * glm::distance(place, *before) : kInfinity;
        auto nearest = scene.nearest(place, std::min(most, near));
        if (!nearest && near < most) nearest = scene.nearest(place, most);  // rounding, or it overflowed
        if (!nearest) continue;
        before = nearest->point;
        const double distance = places.distance(points[i], nearest->point, nearest->distance);
        if (distance > radius) continue;
        const auto number = static_cast<std::int32_t>(query::number_of(context.scene().flat, nearest->ref));
        found_[i] = {distance, space.world(nearest->point), number, nearest->u, nearest->v};
      }
    });
  }

  std::vector<ClosestPoint> found_;
  Sessions<PointSession>::Borrowed session_;
};

// Some points that a place has taken.
struct TakenPoints {
  const QueryContext& context;
  Place& place;
  const PointOptions& options;
  const std::optional<Cancel>& cancel;
  std::size_t first;  // of the points
  std::span<const dvec3> points;
  const PointChunks& all;

  std::vector<std::uint8_t> are_inside(bool in_double) const {
    return query::are_inside(context, place, points, in_double, cancel);
  }
  template <class Column, class ValueOf>
  void fill(const Column& column, const ValueOf& value_of) const {
    if (column.empty()) return;
    column.fill(first, points.size(), [&](std::size_t i) { return std::array{value_of(i - first)}; });
  }
};

template <class Take>
QueryReport for_each_chunk(const QueryContext& context, const Points& points, const PointOptions& options,
                           const Take& take) {
  const auto work = [&](Place& place, RowTaker& rows, const std::optional<Cancel>& cancel) {
    PointChunks chunks(points, options);
    Pace pace(kFirstPoints, kPointsAtOnce, place.sessions.points_at_once);
    for (RowRange next = rows.take(pace.take()); next.n > 0; next = rows.take(pace.take())) {
      throw_if_cancelled(cancel);
      take({context, place, options, cancel, next.first, chunks.take(next.first, next.n), chunks});
      pace.done(next.n);
    }
    return QueryReport{chunks.n_invalid()};
  };
  return share_rows(context, points.size(), kFirstPoints, options.cancel, work);
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
  check_out(out.instance.size(), n, "instance");
  return for_each_chunk(context, points, options, [&](const TakenPoints& chunk) {
    Nearest nearest(context, chunk.place, chunk.points, options.radius);
    const std::vector<ClosestPoint>& found = nearest.wait();
    const auto fill = [&](const auto& column, const auto& value_of) {
      chunk.fill(column, [&](std::size_t i) {
        return value_of(chunk.all.is_invalid(i) ? kNoClosestPoint : found[i]);
      });
    };
    const auto place_of = [&](const ClosestPoint& p) {
      return p.primitive < 0 ? GeometryTable::Place{kNoGeometry, kNoPrimitive}
                             : context.table.of(static_cast<std::uint32_t>(p.primitive));
    };
    fill(out.distance, [](const ClosestPoint& p) { return p.distance; });
    if (!out.point.empty())
      out.point.fill(chunk.first, chunk.points.size(), [&](std::size_t i) {
        const std::size_t at = i - chunk.first;
        const ClosestPoint& p = chunk.all.is_invalid(at) ? kNoClosestPoint : found[at];
        return std::array{p.point.x, p.point.y, p.point.z};
      });
    fill(out.geometry, [&](const ClosestPoint& p) { return place_of(p).geometry; });
    fill(out.primitive, [&](const ClosestPoint& p) { return place_of(p).primitive; });
    fill(out.u, [&](const ClosestPoint& p) { return place_of(p).is_mirrored ? p.v : p.u; });
    fill(out.v, [&](const ClosestPoint& p) { return place_of(p).is_mirrored ? p.u : p.v; });
    fill(out.instance, [&](const ClosestPoint& p) { return place_of(p).instance; });
  });
}

QueryReport inside(const QueryContext& context, const Points& points, const BytesOut& out,
                   const PointOptions& options) {
  check_out(out.size(), points.size(), "inside");
  const bool in_double = are_doubles(points);
  return for_each_chunk(context, points, options, [&](const TakenPoints& chunk) {
    const std::vector<std::uint8_t> found = chunk.are_inside(in_double);
    chunk.fill(out, [&](std::size_t i) { return chunk.all.is_invalid(i) ? std::uint8_t{0} : found[i]; });
  });
}

QueryReport signed_distance(const QueryContext& context, const Points& points, const ValuesOut& out,
                            const PointOptions& options) {
  prepare::refuse_instances(context.scene(), "signed distances");
  check_out(out.size(), points.size(), "distance");
  const bool in_double = are_doubles(points);
  return for_each_chunk(context, points, options, [&](const TakenPoints& chunk) {
    Nearest nearest(context, chunk.place, chunk.points, options.radius);
    const std::vector<std::uint8_t> inside = chunk.are_inside(in_double);
    const std::vector<ClosestPoint>& found = nearest.wait();
    chunk.fill(out, [&](std::size_t i) {
      if (chunk.all.is_invalid(i)) return chunk.all.signed_distance(i);
      return inside[i] ? -found[i].distance : found[i].distance;
    });
  });
}

}  // namespace kdray::query
