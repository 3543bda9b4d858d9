// What    A program's rays, float or double, as the kernels take them: in the scene's own space, in float.
// Shape   A chunk of Rays -> layout::QueryRay, and what turns the answers back: of each ray, how far ahead of
//         its origin it begins, and by which power of two its t is scaled.
// Errors  A ray that means nothing becomes one that meets nothing, and is counted; the first one's number is
//         kept.
//         In double a ray begins where it enters the scene's bounds, so that it is as exact there as one that
//         starts beside them: origin + ahead * direction is rounded once, to float, whatever `ahead` is,
//         and t comes back as ahead + t in double. A ray of floats is begun elsewhere only from over 2^60
//         times the scene's size away. Else the origin, less the scene's centre, and the
//         direction are rounded to float once; lengths change by powers of two.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/box.h"
#include "base/local_space.h"
#include "engine/query/check_rays.h"
#include "kdray/query.h"
#include "layout/rays.layout.h"
#include "scene/model/geometry.h"

namespace kdray::query {

// The rows of arrays that have one for each ray, or one for all: checked once.
class RayArrays {
 public:
  // Throws ErrorCode::input where the sizes don't match.
  explicit RayArrays(const Rays& rays);

  std::size_t size() const { return n_; }
  const Rays& rays() const { return rays_; }
  dvec3 origin(std::size_t i) const { return vector(rays_.origins[rays_.origins.size() == 1 ? 0 : i]); }
  dvec3 direction(std::size_t i) const {
    return vector(rays_.directions[rays_.directions.size() == 1 ? 0 : i]);
  }
  // -infinity is the least number: a whole line's.
  double t_min(std::size_t i) const {
    return std::max(value(rays_.t_min, i, 0), std::numeric_limits<double>::lowest());
  }
  double t_max(std::size_t i) const { return value(rays_.t_max, i, std::numeric_limits<double>::infinity()); }
  // The same for t in double, which rays of floats are told rounded: what would be told as t_min, or as
  // t_max, lies beyond them.
  double double_t_min(std::size_t i) const {
    return in_double_ || rays_.t_min.empty() ? t_min(i) : last_rounded_to(t_min(i), 1);
  }
  double double_t_max(std::size_t i) const {
    return in_double_ || rays_.t_max.empty() ? t_max(i) : last_rounded_to(t_max(i), -1);
  }
  std::uint32_t mask(std::size_t i) const {
    return rays_.masks.empty() ? 0xffffffffu : rays_.masks[rays_.masks.size() == 1 ? 0 : i][0];
  }
  bool in_double() const { return in_double_; }  // whether one of the arrays is

 private:
  static dvec3 vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }
  // The last double above (way: 1) or below (-1) a float that rounds to it; 0 and what is infinite stay.
  static double last_rounded_to(double t, int way);
  static double value(const Values& values, std::size_t i, double none) {
    return values.empty() ? none : values[values.size() == 1 ? 0 : i][0];
  }

  Rays rays_;
  std::size_t n_;
  bool in_double_;
};

// A ray that begins `ahead` of its origin: t = ahead + ldexp(local t, exponent).
struct LocalRay {
  layout::QueryRay ray;
  double ahead;
  int exponent;
};

// A ray that meets nothing.
inline constexpr layout::QueryRay kNoRay{{0, 0, 0}, 0, {1, 0, 0}, -std::numeric_limits<float>::infinity()};

// Returns what rounding took from the difference a - b (Knuth's two-sum).
inline dvec3 lost_of(const dvec3& a, const dvec3& b, const dvec3& difference) {
  const dvec3 back = a - difference;
  return (a - (difference + back)) - (b - back);
}

// A line in the space of a scene of doubles: exactly origin + rest + t*direction. t is 2^-exponent times the
// caller's. In a DoubleRay components below DoubleGeometry::kLeast are 0.
struct DoubleLine {
  dvec3 origin, rest, direction;
  int exponent;
  double unit;  // 2^exponent, or 0 where that is no ordinary double

  double caller_t(double t) const { return unit != 0 ? t * unit : std::scalbn(t, exponent); }
  void shorten(int by) {
    for (int k = 0; k < 3; ++k) direction[k] = std::scalbn(direction[k], -by);
    exponent -= by;
    unit = 0;
  }
  void drop_tiny() {
    for (dvec3* v : {&origin, &rest, &direction})
      for (int k = 0; k < 3; ++k)
        if (std::abs((*v)[k]) < scene::DoubleGeometry::kLeast) (*v)[k] = 0;
  }
};

// A ray of a scene of doubles. A walk in floats may begin at `start`, before anything lies.
struct DoubleRay {
  DoubleLine line;
  double start, t_min, t_max;

  // Rounded once, however far off the origin is.
  dvec3 place_at_start() const {
    dvec3 place;
    for (int k = 0; k < 3; ++k)
      place[k] = start == 0 ? line.origin[k] + line.rest[k]
                            : std::fma(start, line.direction[k], line.origin[k]) + line.rest[k];
    return place;
  }
};

// Below and above a value, by a last place of float or two.
inline float rounded_down(double value) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return std::nextafterf(static_cast<float>(std::clamp(value, -kMost, kMost)), -HUGE_VALF);
}
inline float rounded_up(double value) {
  return -rounded_down(-value);
}

// The same in doubles: t = ldexp(ahead + local t, exponent).
struct LocalLine {
  dvec3 origin, direction;
  double ahead;  // in multiples of the local direction
  int exponent;
};

class LocalFrame {
 public:
  // Of its space and bounds, which what lies in it may leave by `apart`.
  explicit LocalFrame(const scene::Geometry& geometry, double apart = 0);

  // None where it passes the bounds by, or stays too far from them for floats.
  std::optional<LocalLine> line(const dvec3& origin, const dvec3& direction, bool in_double) const;
  // The same line in the space of a scene of doubles.
  DoubleLine double_line(const dvec3& origin, const dvec3& direction) const {
    const dvec3 from_center = origin - space_.center;
    DoubleLine line{from_center * space_.scale, lost_of(origin, space_.center, from_center) * space_.scale,
                    direction, exponent_, ordinary_unit()};
    if (const double largest = largest_component(direction); !is_ordinary_length(largest)) [[unlikely]]
      line.shorten(std::ilogb(largest));
    return line;
  }
  // None where line() has none.
  std::optional<DoubleRay> double_ray(const dvec3& origin, const dvec3& direction, double t_min,
                                      double t_max) const;
  LocalRay begin(const dvec3& origin, const dvec3& direction, double t_min, double t_max,
                 bool in_double) const;
  // The exponent of rays that need no more: those of ordinary length that are not moved.
  int exponent() const { return exponent_; }
  double unit() const { return unit_; }  // 2^exponent()
  // The same where it and its inverse are ordinary doubles, or 0: of scenes of any size that floats can have.
  double ordinary_unit() const { return std::isnormal(unit_) && std::isnormal(1 / unit_) ? unit_ : 0; }
  // A t of the caller's in multiples of the line's direction, and back. (A power of two needs no call.)
  double local_t(const LocalLine& line, double t) const {
    return line.exponent == exponent_ && ordinary_unit() != 0 ? t / unit_ : std::scalbn(t, -line.exponent);
  }
  double caller_t(const LocalLine& line, double t) const {
    return line.exponent == exponent_ && ordinary_unit() != 0 ? t * unit_ : std::scalbn(t, line.exponent);
  }
  const LocalSpace& space() const { return space_; }
  // Whether a point, in the scene's own space, lies outside of its bounds for certain.
  bool is_outside(const dvec3& local) const {
    return glm::any(glm::lessThan(local, lo_)) || glm::any(glm::greaterThan(local, hi_));
  }

 private:
  double distance_ahead(const dvec3& origin, const dvec3& direction) const;
  std::optional<LocalLine> begin_line(const dvec3& origin, const dvec3& direction, bool in_double) const;

  LocalSpace space_;
  dvec3 lo_, hi_;  // the bounds, a little wider
  int exponent_;
  double unit_;
  double near_;  // origins of doubles within this, along each axis, stay
};

// One chunk after the other; its memory is used again.
class LocalRays {
 public:
  // for_filter: see filter_rays.h; then nothing tells world_t.
  LocalRays(const RayArrays& rays, const LocalFrame& frame, bool for_filter = false)
      : rays_(&rays), frame_(&frame), for_filter_(for_filter) {}

  // Fills out[0, n) with rays [first, first + n), which may be asked for again. One whose mask has no bit
  // meets nothing.
  void fill(std::size_t first, std::size_t n, layout::QueryRay* out);

  // Of ray i of the chunk that was filled last.
  double world_t(std::size_t i, float t) const {
    if (moved_.empty()) return t * frame_->unit();
    return moved_[i].ahead + std::ldexp(double{t}, moved_[i].exponent);
  }

  bool has_moved() const { return !moved_.empty(); }  // rays of that chunk need a t of their own each

  std::uint64_t n_invalid() const { return n_invalid_; }
  std::optional<std::string> first_invalid() const { return first_invalid_; }

 private:
  struct Moved {
    double ahead;
    int exponent;
  };
  void fill_any(std::size_t first, std::size_t n, layout::QueryRay* out);
  void note_invalid(std::size_t first, std::size_t n);

  const RayArrays* rays_;
  const LocalFrame* frame_;
  bool for_filter_;
  std::vector<Moved> moved_;   // empty: all rays of the chunk are as far ahead and as long as usual
  std::size_t looked_at_ = 0;  // rays before this one have been counted where they are invalid
  std::uint64_t n_invalid_ = 0;
  std::optional<std::string> first_invalid_;
};

// The fast way for rays as nearly all are: floats, finite, with directions of ordinary length, not from too
// far off. Same floats as LocalFrame::begin() gives.
//
// Fills out[0, n) with rays [first, first + n) in the scene's own space. False, and `out` has anything, where
// one of them isn't such.
bool fill_plain_floats(const RayArrays& rays, const LocalFrame& frame, std::size_t first, std::size_t n,
                       layout::QueryRay* out);

}  // namespace kdray::query
