#include "engine/query/check_rays.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/error.h"

namespace kdray::query {

const char* fault_of(const dvec3& origin, const dvec3& direction, double t_min, double t_max) {
  if (!is_finite(origin)) return "its origin is not finite";
  if (!is_finite(direction)) return "its direction is not finite";
  if (direction == dvec3(0)) return "its direction is 0";
  if (!std::isfinite(t_min)) return "its t_min is not finite";
  if (std::isnan(t_max)) return "its t_max is not a number";
  return nullptr;
}

const char* fault_of(const Ray& ray) {
  const auto vector = [](const float(&v)[3]) { return dvec3(v[0], v[1], v[2]); };
  return fault_of(vector(ray.origin), vector(ray.direction), ray.t_min, ray.t_max);
}

namespace {

// The bits of floats without signs are ordered as their sizes are; what is no number comes last.
constexpr std::uint32_t kInfinite = 0x7f800000u;

// What some rays come to, over which compilers make vectors of a ray's eight words: all their other forms
// branch, and took a tenth of the time of tracing coherent rays.
class Looked {
 public:
  void at(const Ray& ray) {
    const auto words = std::bit_cast<std::array<std::uint32_t, 8>>(ray);
    std::array<std::uint32_t, 8> size{};
    for (std::size_t k = 0; k < 8; ++k) size[k] = words[k] & 0x7fffffffu;
    // These set the sign's bit where a word is infinite or no number; of t_max, no number alone.
    for (std::size_t k = 0; k < 8; ++k) beyond_[k] |= size[k] + (k == 7 ? 0x007fffffu : 0x00800000u);
    for (std::size_t k = 0; k < 8; ++k)
      largest_[k] = std::max(largest_[k], static_cast<std::int32_t>(size[k]));
    const std::uint32_t length = std::max({size[4], size[5], size[6]});
    shortest_ = std::min(shortest_, length);
    longest_ = std::max(longest_, length);
  }
  void add(const Looked& other) {
    for (std::size_t k = 0; k < 8; ++k) {
      beyond_[k] |= other.beyond_[k];
      largest_[k] = std::max(largest_[k], other.largest_[k]);
    }
    shortest_ = std::min(shortest_, other.shortest_);
    longest_ = std::max(longest_, other.longest_);
  }

  bool all_are_rays() const {
    std::uint32_t any = 0;
    for (const std::uint32_t word : beyond_) any |= word;
    return any >> 31 == 0 && shortest_ > 0;
  }
  bool all_are_ordinary() const {
    return shortest_ >= std::bit_cast<std::uint32_t>(kShortestOrdinary) &&
           longest_ < std::bit_cast<std::uint32_t>(kLongestOrdinary);
  }
  float farthest() const {
    return std::bit_cast<float>(
        static_cast<std::uint32_t>(std::max({largest_[0], largest_[1], largest_[2]})));
  }

 private:
  std::array<std::uint32_t, 8> beyond_{};
  std::array<std::int32_t, 8> largest_{};
  std::uint32_t shortest_ = kInfinite, longest_ = 0;
};

static_assert(sizeof(Ray) == 32 && offsetof(Ray, direction) == 16 && offsetof(Ray, t_max) == 28);

}  // namespace

namespace {

Looked look(const Ray* first, const Ray* last, Looked looked = {}) {
  for (; first != last; ++first) looked.at(*first);
  return looked;
}

RaysSeen told(std::span<const Ray> rays, const Looked& seen) {
  std::size_t fault = rays.size();
  if (!seen.all_are_rays())
    fault = static_cast<std::size_t>(
        std::find_if(rays.begin(), rays.end(), [](const Ray& r) { return fault_of(r); }) - rays.begin());
  const float farthest = seen.farthest();
  return {rays.size(), fault, seen.all_are_ordinary(), std::isnan(farthest) ? HUGE_VALF : farthest};
}

}  // namespace

RaysSeen look_at(std::span<const Ray> rays) {
  constexpr std::size_t kGrain = 1 << 14;
  if (rays.size() <= kGrain) return told(rays, look(rays.data(), rays.data() + rays.size()));
  const Looked seen = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, rays.size(), kGrain), Looked(),
      [&](const tbb::blocked_range<std::size_t>& range, const Looked& looked) {
        return look(rays.data() + range.begin(), rays.data() + range.end(), looked);
      },
      [](Looked a, const Looked& b) {
        a.add(b);
        return a;
      });
  return told(rays, seen);
}

void refuse_faulty(std::span<const Ray> rays, const RaysSeen& seen, std::size_t first) {
  if (seen.first_fault == seen.n_rays) return;
  throw Error(ErrorCode::input, fmt::format("ray {}: {}; take it out or repair it", first + seen.first_fault,
                                            fault_of(rays[seen.first_fault])));
}

void check_rays(std::span<const Ray> rays) {
  refuse_faulty(rays, look_at(rays));
}

std::vector<Ray> without_faulty(std::span<const Ray> rays) {
  constexpr Ray kNone{{0, 0, 0}, 0, {0, 0, 1}, -1};
  std::vector<Ray> kept(rays.begin(), rays.end());
  std::replace_if(
      kept.begin(), kept.end(), [](const Ray& ray) { return fault_of(ray) != nullptr; }, kNone);
  return kept;
}

bool is_ordinary(const Ray& ray) {
  const auto& d = ray.direction;
  return is_ordinary_length(std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])}));
}

}  // namespace kdray::query
