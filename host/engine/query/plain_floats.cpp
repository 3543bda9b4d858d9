#include "engine/query/local_rays.h"

#include <atomic>
#include <cmath>
#include <cstring>

#include "engine/query/check_rays.h"
#include "engine/query/grains.h"

namespace kdray::query {

namespace {

// Compilers make their vectors of it that any processor of the kind has.
using Lanes = float __attribute__((vector_size(16)));
using Select = int __attribute__((vector_size(16)));
using Bits = unsigned __attribute__((vector_size(16)));

constexpr float kNearEnough = 0x1p60f;  // in local lengths: begin() leaves origins within it

Lanes all_lanes(float x) {
  return Lanes{x, x, x, x};
}

// Four floats, of which a row has three: what lies behind the last row is not the caller's to be read.
Lanes four_at(const std::byte* at) {
  Lanes lanes;
  std::memcpy(&lanes, at, sizeof lanes);
  return lanes;
}
Lanes three_at(const std::byte* at) {
  float row[4] = {};
  std::memcpy(row, at, 3 * sizeof(float));
  return Lanes{row[0], row[1], row[2], row[3]};
}

// Rows of floats, or one for all of them.
class Column {
 public:
  template <class View>
  Column(const View& view, float none)
      : first_(view.empty() ? nullptr
                            : reinterpret_cast<const std::byte*>(view.template first_of<const float>())),
        stride_(view.size() == 1 ? 0 : view.stride()),
        usable_(view.empty() || first_ != nullptr),
        none_(none) {}

  bool usable() const { return usable_; }  // floats, or nothing
  // Whether four floats may be read at every row but the last.
  bool has_four() const { return stride_ >= sizeof(float); }
  const std::byte* row(std::size_t i) const { return first_ + i * stride_; }
  float value(std::size_t i) const {
    if (first_ == nullptr) return none_;
    float value;
    std::memcpy(&value, row(i), sizeof value);
    return value;
  }

 private:
  const std::byte* first_;
  std::size_t stride_;
  bool usable_;
  float none_;
};

class PlainRays {
 public:
  PlainRays(const RayArrays& rays, const LocalSpace& space)
      : n_(rays.size()),
        origins_(rays.rays().origins, 0),
        directions_(rays.rays().directions, 0),
        t_min_(rays.rays().t_min, 0),
        t_max_(rays.rays().t_max, std::numeric_limits<float>::infinity()),
        scale_(static_cast<float>(space.scale)),
        center_{static_cast<float>(space.center.x), static_cast<float>(space.center.y),
                static_cast<float>(space.center.z), 0} {
    // A power of two, and a centre that floats hold (scene/model/geometry.h): a coordinate less it is rounded
    // once, in float or in double.
    usable_ = origins_.usable() && directions_.usable() && t_min_.usable() && t_max_.usable() &&
              scale_ >= std::numeric_limits<float>::min() && std::isfinite(scale_) &&
              double{center_[0]} == space.center.x && double{center_[1]} == space.center.y &&
              double{center_[2]} == space.center.z;
  }

  bool usable() const { return usable_; }

  // Fills out[0, n) with rays [first, first + n), and says whether all are such.
  bool fill(std::size_t first, std::size_t n, layout::QueryRay* out) const {
    if (n == 0) return true;
    const PlainRays rays = *this;  // what is written might be this, for all that compilers know
    Looked looked;
    const bool with_last = first + n == n_;
    const std::size_t n_fours = n - with_last;
    if (rays.origins_.has_four() && rays.directions_.has_four())
      for (std::size_t i = 0; i < n_fours; ++i)
        looked.at(rays.put(first + i, four_at(rays.origins_.row(first + i)),
                           four_at(rays.directions_.row(first + i)), out[i]));
    else
      for (std::size_t i = 0; i < n_fours; ++i)
        looked.at(rays.put(first + i, three_at(rays.origins_.row(first + i)),
                           three_at(rays.directions_.row(first + i)), out[i]));
    if (with_last)
      looked.at(rays.put(n_ - 1, three_at(rays.origins_.row(n_ - 1)), three_at(rays.directions_.row(n_ - 1)),
                         out[n - 1]));
    return looked.all_are_plain();
  }

 private:
  // A ray as it is in memory.
  struct Halves {
    Lanes origin, direction;  // and t_min, t_max
  };
  Halves put(std::size_t i, const Lanes& origin, const Lanes& direction, layout::QueryRay& out) const {
    constexpr Select kRow = {-1, -1, -1, 0};
    const Halves ray{kRow ? (origin - center_) * scale_ : all_lanes(t_min_.value(i) * scale_),
                     kRow ? direction : all_lanes(t_max_.value(i) * scale_)};
    static_assert(sizeof ray == sizeof out);
    std::memcpy(&out, &ray, sizeof ray);
    return ray;
  }

  // What some rays come to.
  class Looked {
   public:
    void at(const Halves& ray) {
      const Bits origin = (Bits)ray.origin & 0x7fffffffu, along = (Bits)ray.direction & 0x7fffffffu;
      // Sets the sign's bit where a float is infinite or no number; of t_max, no number alone.
      constexpr Bits kFinite = {0x00800000, 0x00800000, 0x00800000, 0x007fffff};
      beyond_ |= (Select)((origin + 0x00800000u) | (along + kFinite));
      farthest_ = greater(farthest_, (Lanes)origin);
      const Lanes size = (Lanes)along;
      const Lanes largest = greater(size, greater(__builtin_shufflevector(size, size, 1, 2, 0, 3),
                                                  __builtin_shufflevector(size, size, 2, 0, 1, 3)));
      longest_ = greater(longest_, largest);
      shortest_ = largest < shortest_ ? largest : shortest_;
    }
    bool all_are_plain() const {
      const bool finite = (beyond_[0] | beyond_[1] | beyond_[2] | beyond_[3]) >= 0;
      return finite && farthest_[0] < kNearEnough && farthest_[1] < kNearEnough &&
             farthest_[2] < kNearEnough && shortest_[0] >= kShortestOrdinary &&
             longest_[0] < kLongestOrdinary;
    }

   private:
    static Lanes greater(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
    Select beyond_ = {};
    Lanes farthest_ = {}, longest_ = {}, shortest_ = all_lanes(std::numeric_limits<float>::infinity());
  };

  std::size_t n_;
  Column origins_, directions_, t_min_, t_max_;
  float scale_;
  Lanes center_;
  bool usable_;
};

}  // namespace

bool fill_plain_floats(const RayArrays& rays, const LocalFrame& frame, std::size_t first, std::size_t n,
                       layout::QueryRay* out) {
  const PlainRays plain(rays, frame.space());
  if (!plain.usable()) return false;
  std::atomic<bool> all{true};
  for_each_grain(n, [&](std::size_t begin, std::size_t end) {
    if (!plain.fill(first + begin, end - begin, out + begin)) all.store(false, std::memory_order_relaxed);
  });
  return all.load();
}

}  // namespace kdray::query
