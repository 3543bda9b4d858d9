#include "engine/query/filter_rays.h"

#include "base/highway_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/query/filter_rays.cpp"
// First, as it includes this file for each instruction set.
#include "hwy/foreach_target.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/query/check_rays.h"
#include "engine/query/grains.h"
#include "hwy/highway.h"

#ifndef KDRAY_QUERY_FILTER_ROWS
#define KDRAY_QUERY_FILTER_ROWS
namespace kdray::query {

constexpr std::size_t kRaysAtOnce = 8;

// The caller's rays, one after the other: where they are in the caller's memory, or copies.
struct FilterRows {
  const double *origin, *direction, *t_min, *t_max;
};

struct FilterSpace {
  double center[3], scale, per_unit;  // local t = t * per_unit; NaN: no ray is ordinary
};

// In the order of QueryRay's fields.
struct FilteredRows {
  float fields[8][kRaysAtOnce];
  double is_ordinary[kRaysAtOnce];  // else 0, and the fields mean nothing
};

}  // namespace kdray::query
#endif

HWY_BEFORE_NAMESPACE();
namespace kdray::query::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kRaysAtOnce>;
using V = hn::Vec<D>;

HWY_ATTR inline void store_floats(V v, float* to) {
  const hn::Rebind<float, D> floats;
  hn::StoreU(hn::DemoteTo(floats, v), floats, to);
}

HWY_ATTR inline V sum_of_sizes(const V (&v)[3]) {
  return hn::Add(hn::Abs(v[0]), hn::Add(hn::Abs(v[1]), hn::Abs(v[2])));
}

HWY_ATTR inline V dot(const V (&a)[3], const V (&b)[3]) {
  return hn::MulAdd(a[0], b[0], hn::MulAdd(a[1], b[1], hn::Mul(a[2], b[2])));
}

// Lanes from `lane` on, as many as a vector has.
HWY_ATTR inline void filter_lanes(const FilterRows& rays, const FilterSpace& space, std::size_t lane,
                                  FilteredRows& out) {
  constexpr double kFarther = 0x1p13, kFarthest = 0x1p30, kLeastOutward = 0x1p-22;
  const D d;
  const auto all = [&](double x) HWY_ATTR { return hn::Set(d, x); };
  V origin[3], local[3], rest[3], direction[3];
  hn::LoadInterleaved3(d, rays.origin + 3 * lane, origin[0], origin[1], origin[2]);
  hn::LoadInterleaved3(d, rays.direction + 3 * lane, direction[0], direction[1], direction[2]);
  for (int k = 0; k < 3; ++k) {
    const V center = all(space.center[k]);
    const V from_center = hn::Sub(origin[k], center), back = hn::Sub(origin[k], from_center);
    const V lost = hn::Sub(hn::Sub(origin[k], hn::Add(from_center, back)), hn::Sub(center, back));
    local[k] = hn::Mul(from_center, all(space.scale));
    rest[k] = hn::Mul(lost, all(space.scale));
  }
  const V way = sum_of_sizes(local), length = sum_of_sizes(direction);
  const auto is_far = hn::Gt(way, all(kFarther));
  // Before it enters the ball about the centre that the scene lies in, whose reach is below 2^11 along each
  // axis: frusta want t from 0 on.
  V start = hn::Zero(d);
  if (!hn::AllFalse(d, is_far)) {
    const V length2 = dot(direction, direction);
    const V nearest = hn::Neg(hn::Div(dot(local, direction), length2));
    const V before = hn::Div(all(0x1.cp11), hn::Sqrt(length2));
    start = hn::IfThenElseZero(is_far, hn::Sub(nearest, before));
  }
  for (int k = 0; k < 3; ++k) {
    store_floats(hn::Add(hn::MulAdd(start, direction[k], local[k]), rest[k]), out.fields[k] + lane);
    store_floats(direction[k], out.fields[4 + k] + lane);
  }
  const V t_min = hn::Mul(hn::LoadU(d, rays.t_min + lane), all(space.per_unit));
  const V t_max = hn::Mul(hn::LoadU(d, rays.t_max + lane), all(space.per_unit));
  const V since = hn::Sub(t_min, start);  // nothing lies before 0
  const V begin = hn::IfThenElse(is_far, hn::Max(since, hn::Zero(d)), since), end = hn::Sub(t_max, start),
          outward = all(kLeastOutward);
  store_floats(hn::NegMulAdd(hn::Abs(begin), outward, begin), out.fields[3] + lane);
  store_floats(hn::MulAdd(hn::Abs(end), outward, end), out.fields[7] + lane);
  // NaN is in no order.
  const auto has_length =
      hn::And(hn::Ge(length, all(3 * double{kShortestOrdinary})), hn::Lt(length, all(kLongestOrdinary)));
  const auto has_place = hn::And(hn::Le(way, all(kFarthest)), hn::Le(hn::Abs(since), all(0x1p100)));
  const auto is_ordinary = hn::And(hn::And(has_length, has_place), hn::Gt(t_max, all(-HUGE_VAL)));
  hn::StoreU(hn::IfThenElseZero(is_ordinary, all(1)), d, out.is_ordinary + lane);
}

HWY_ATTR void FilterAll(const FilterRows& rays, const FilterSpace& space, FilteredRows& out) {
  for (std::size_t lane = 0; lane < kRaysAtOnce; lane += hn::Lanes(D())) filter_lanes(rays, space, lane, out);
}

}  // namespace kdray::query::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kdray::query {

HWY_EXPORT(FilterAll);

namespace {

layout::QueryRay filter_ray(const LocalFrame& frame, const RayArrays& rays, std::size_t i) {
  const auto ray =
      frame.double_ray(rays.origin(i), rays.direction(i), rays.double_t_min(i), rays.double_t_max(i));
  if (!ray) return kNoRay;
  const dvec3 start = ray->place_at_start();
  layout::QueryRay out;
  for (int k = 0; k < 3; ++k) {
    out.origin[k] = static_cast<float>(start[k]);
    out.direction[k] = static_cast<float>(ray->line.direction[k]);
  }
  // Finite, as every ray's.
  out.t_min = std::max(rounded_down(ray->t_min - ray->start), -std::numeric_limits<float>::max());
  out.t_max = rounded_up(ray->t_max - ray->start);
  return out;
}

// kRaysAtOnce rows of the caller's, one after the other in memory: copied only where they aren't such there.
class EightRows {
 public:
  explicit EightRows(const RayArrays& rays)
      : rays_(rays),
        are_origins_dense_(is_dense(rays.rays().origins, rays.size())),
        are_directions_dense_(is_dense(rays.rays().directions, rays.size())) {
    std::fill_n(t_min_, kRaysAtOnce, 0);
    std::fill_n(t_max_, kRaysAtOnce, std::numeric_limits<double>::infinity());
  }

  // Rays from i on; behind the last of n the last one again.
  FilterRows at(std::size_t i, std::size_t n) {
    const bool all = n == kRaysAtOnce;
    const Rays& rays = rays_.rays();
    for (std::size_t lane = 0; lane < kRaysAtOnce; ++lane) {
      const std::size_t ray = i + std::min(lane, n - 1);
      if (!all || !are_origins_dense_) put(origins_ + 3 * lane, rays_.origin(ray));
      if (!all || !are_directions_dense_) put(directions_ + 3 * lane, rays_.direction(ray));
      if (!rays.t_min.empty()) t_min_[lane] = rays_.double_t_min(ray);
      if (!rays.t_max.empty()) t_max_[lane] = rays_.double_t_max(ray);
    }
    return {all && are_origins_dense_ ? rays.origins.first_of<const double>() + 3 * i : origins_,
            all && are_directions_dense_ ? rays.directions.first_of<const double>() + 3 * i : directions_,
            t_min_, t_max_};
  }

 private:
  static bool is_dense(const Points& points, std::size_t n) {
    const double* const first = points.first_of<const double>();
    return points.size() == n && first != nullptr && points.stride() == 3 * sizeof(double) &&
           reinterpret_cast<std::uintptr_t>(first) % alignof(double) == 0;
  }
  static void put(double* row, const dvec3& v) {
    for (int k = 0; k < 3; ++k) row[k] = v[k];
  }

  const RayArrays& rays_;
  bool are_origins_dense_, are_directions_dense_;
  double origins_[3 * kRaysAtOnce], directions_[3 * kRaysAtOnce], t_min_[kRaysAtOnce], t_max_[kRaysAtOnce];
};

layout::QueryRay ray_of(const FilteredRows& rows, std::size_t lane) {
  const auto& f = rows.fields;
  return {{f[0][lane], f[1][lane], f[2][lane]}, f[3][lane], {f[4][lane], f[5][lane], f[6][lane]}, f[7][lane]};
}

}  // namespace

bool fill_filter_rays(const RayArrays& rays, const LocalFrame& frame, std::size_t first, std::size_t n,
                      layout::QueryRay* out) {
  const LocalSpace& s = frame.space();
  const FilterSpace space{
      {s.center.x, s.center.y, s.center.z}, s.scale, frame.ordinary_unit() != 0 ? 1 / frame.unit() : NAN};
  std::atomic<bool> valid{true};
  for_each_grain(n, [&](std::size_t begin, std::size_t end) {
    EightRows rows(rays);
    FilteredRows filtered;
    for (std::size_t at = begin; at < end; at += kRaysAtOnce) {
      const std::size_t n_lanes = std::min(kRaysAtOnce, end - at);
      HWY_DYNAMIC_DISPATCH(FilterAll)(rows.at(first + at, n_lanes), space, filtered);
      for (std::size_t lane = 0; lane < n_lanes; ++lane) {
        const std::size_t i = first + at + lane;
        if (filtered.is_ordinary[lane] != 0) {
          out[at + lane] = ray_of(filtered, lane);
        } else if (fault_of(rays.origin(i), rays.direction(i), rays.t_min(i), rays.t_max(i)) == nullptr) {
          out[at + lane] = filter_ray(frame, rays, i);
        } else {
          out[at + lane] = kNoRay;
          valid.store(false, std::memory_order_relaxed);
        }
      }
    }
  });
  return valid;
}

}  // namespace kdray::query
#endif
