#include "engine/query/local_rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/error.h"
#include "engine/query/check_rays.h"
#include "engine/query/filter_rays.h"
#include "engine/query/grains.h"
#include "engine/query/near_rays.h"

namespace kdray::query {

namespace {

void check_size(std::size_t size, std::size_t n, const char* name) {
  if (size == n || size <= 1) return;
  throw Error(ErrorCode::input,
              fmt::format("rays: {} of {} for {} rays; give one for each, or one", size, name, n));
}

template <class View>
bool is_double(const View& view) {
  return !view.empty() && view.template first_of<const double>() != nullptr;
}

}  // namespace

RayArrays::RayArrays(const Rays& rays)
    : rays_(rays),
      n_(std::max(rays.origins.size(), rays.directions.size())),
      in_double_(is_double(rays.origins) || is_double(rays.directions) || is_double(rays.t_min) ||
                 is_double(rays.t_max)) {
  if (rays.origins.empty() || rays.directions.empty()) {
    if (n_ > 0)
      throw Error(ErrorCode::input, "rays: origins without directions, or directions without origins");
    return;
  }
  n_ = std::max({n_, rays.t_min.size(), rays.t_max.size(), rays.masks.size()});
  check_size(rays.origins.size(), n_, "origins");
  check_size(rays.directions.size(), n_, "directions");
  check_size(rays.t_min.size(), n_, "t_min");
  check_size(rays.t_max.size(), n_, "t_max");
  check_size(rays.masks.size(), n_, "masks");
}

// Half way to the next float a double rounds to the even one of the two.
double RayArrays::last_rounded_to(double t, int way) {
  if (t == 0 || !std::isfinite(t)) return t;
  const auto f = static_cast<float>(t);
  const double next = std::nextafter(f, way * HUGE_VALF), half_way = 0.5 * (t + next);
  return static_cast<float>(half_way) == f ? half_way : std::nextafter(half_way, t);
}

LocalFrame::LocalFrame(const scene::Geometry& geometry, double apart)
    : space_(geometry.space),
      lo_(0),
      hi_(0),
      exponent_(-std::ilogb(geometry.space.scale)),
      unit_(std::ldexp(1.0, exponent_)),
      near_(2 * kLocalReach) {
  if (geometry.bounds.empty()) return;
  // By more than a ray may be off for being rounded to float.
  const double wider = 0x1p-12 * kLocalReach + apart;
  lo_ = dvec3(geometry.bounds.lo) - wider;
  hi_ = dvec3(geometry.bounds.hi) + wider;
  near_ = std::max({near_, largest_component(lo_), largest_component(hi_)});
}

// Where the line enters the bounds, in multiples of the direction; infinity: it passes them by.
double LocalFrame::distance_ahead(const dvec3& origin, const dvec3& direction) const {
  double enter = -HUGE_VAL, leave = HUGE_VAL;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) {
      if (origin[k] < lo_[k] || origin[k] > hi_[k]) return HUGE_VAL;
      continue;
    }
    const double a = (lo_[k] - origin[k]) / direction[k], b = (hi_[k] - origin[k]) / direction[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  // These are off by some roundings: a ray that all but touches the bounds has to go on.
  return enter <= leave + 0x1p-48 * std::abs(leave) ? enter : HUGE_VAL;
}

// A call for each ray would take a fifth of the time of any-hit queries.
[[gnu::always_inline]] inline std::optional<LocalLine> LocalFrame::begin_line(const dvec3& world_origin,
                                                                              const dvec3& world_direction,
                                                                              bool in_double) const {
  const double largest = largest_component(world_direction);
  const int length = is_ordinary_length(largest) ? 0 : std::ilogb(largest);
  const dvec3 direction =
      length == 0 ? world_direction
                  : dvec3(std::scalbn(world_direction.x, -length), std::scalbn(world_direction.y, -length),
                          std::scalbn(world_direction.z, -length));
  // In local lengths from here on. The origin is the sum of two doubles, since the difference is rounded.
  dvec3 origin = world_origin - space_.center;
  const dvec3 rest = lost_of(world_origin, space_.center, origin);
  origin *= space_.scale;
  double ahead = 0;
  if (!(largest_component(origin) <= (in_double ? near_ : kFar))) {
    ahead = distance_ahead(origin, direction);
    if (!std::isfinite(ahead)) return std::nullopt;
    for (int k = 0; k < 3; ++k) origin[k] = std::fma(ahead, direction[k], origin[k]) + rest[k] * space_.scale;
    if (!(largest_component(origin) <= kFar)) return std::nullopt;
  }
  return LocalLine{origin, direction, ahead, exponent_ - length};
}

std::optional<LocalLine> LocalFrame::line(const dvec3& origin, const dvec3& direction, bool in_double) const {
  return begin_line(origin, direction, in_double);
}

std::optional<DoubleRay> LocalFrame::double_ray(const dvec3& origin, const dvec3& direction, double t_min,
                                                double t_max) const {
  const std::optional<LocalLine> line = begin_line(origin, direction, true);
  if (!line) return std::nullopt;
  DoubleRay ray{double_line(origin, direction), line->ahead, local_t(*line, t_min), local_t(*line, t_max)};
  ray.line.drop_tiny();
  return ray;
}

LocalRay LocalFrame::begin(const dvec3& origin, const dvec3& direction, double t_min, double t_max,
                           bool in_double) const {
  LocalRay out{kNoRay, 0, exponent_};
  const std::optional<LocalLine> line = begin_line(origin, direction, in_double);
  if (!line) return out;
  out.exponent = line->exponent;
  for (int k = 0; k < 3; ++k) {
    out.ray.origin[k] = static_cast<float>(line->origin[k]);
    out.ray.direction[k] = static_cast<float>(line->direction[k]);
  }
  // Finite, as every ray's: beyond float's range nothing lies between it and the scene.
  constexpr double kMost = std::numeric_limits<float>::max();
  out.ray.t_min =
      static_cast<float>(std::clamp(std::scalbn(t_min, -out.exponent) - line->ahead, -kMost, kMost));
  out.ray.t_max = static_cast<float>(std::scalbn(t_max, -out.exponent) - line->ahead);
  out.ahead = std::scalbn(line->ahead, out.exponent);
  return out;
}

void LocalRays::fill(std::size_t first, std::size_t n, layout::QueryRay* out) {
  moved_.clear();
  if (for_filter_) {
    if (!fill_filter_rays(*rays_, *frame_, first, n, out)) note_invalid(first, n);
  } else if (!fill_plain_floats(*rays_, *frame_, first, n, out)) {
    fill_any(first, n, out);
  }
  if (rays_->rays().masks.empty()) return;
  for (std::size_t i = 0; i < n; ++i)
    if (rays_->mask(first + i) == 0) out[i] = kNoRay;
}

void LocalRays::fill_any(std::size_t first, std::size_t n, layout::QueryRay* out) {
  moved_.resize(n);
  std::atomic<bool> usual{true}, valid{true};
  for_each_grain(n, [&](std::size_t begin, std::size_t end) {
    bool all_usual = true, all_valid = true;
    for (std::size_t i = begin; i < end; ++i) {
      const dvec3 o = rays_->origin(first + i), d = rays_->direction(first + i);
      const double t_min = rays_->t_min(first + i), t_max = rays_->t_max(first + i);
      LocalRay local{kNoRay, 0, frame_->exponent()};
      if (fault_of(o, d, t_min, t_max) != nullptr) {
        all_valid = false;
      } else {
        local = frame_->begin(o, d, t_min, t_max, rays_->in_double());
      }
      out[i] = local.ray;
      moved_[i] = {local.ahead, local.exponent};
      all_usual &= local.ahead == 0 && local.exponent == frame_->exponent();
    }
    if (!all_usual) usual.store(false, std::memory_order_relaxed);
    if (!all_valid) valid.store(false, std::memory_order_relaxed);
  });
  if (usual) moved_.clear();
  if (!valid) note_invalid(first, n);
}

void LocalRays::note_invalid(std::size_t first, std::size_t n) {
  for (std::size_t i = std::max(first, looked_at_); i < first + n; ++i) {
    const char* const fault =
        fault_of(rays_->origin(i), rays_->direction(i), rays_->t_min(i), rays_->t_max(i));
    if (fault == nullptr) continue;
    ++n_invalid_;
    if (!first_invalid_) first_invalid_ = fmt::format("ray {}: {}; take it out or repair it", i, fault);
  }
  looked_at_ = std::max(looked_at_, first + n);
}

}  // namespace kdray::query
