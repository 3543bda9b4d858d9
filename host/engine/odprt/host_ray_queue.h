// What    Rays on their way through the host's memory: between contexts, and to parts that nobody serves at
//         the moment.
// Shape   For each slice the rays that wait, as structures of their fields (kernels/layout/rays.layout.h),
//         taken from the end.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/odprt/outbox.h"
#include "layout/rays.layout.h"

namespace kdray::odprt {

// n_fields words to a ray.
class RayPile {
 public:
  explicit RayPile(std::uint32_t n_fields) : n_fields_(n_fields) {}

  std::uint32_t n_fields() const { return n_fields_; }
  std::size_t size() const { return words_.size() / n_fields_; }

  // Ray i of a stream: its field f is at stream[f*capacity + i].
  void put(const float* stream, std::size_t capacity, std::size_t i) {
    const std::size_t first = words_.size();
    words_.resize(first + n_fields_);
    for (std::uint32_t f = 0; f < n_fields_; ++f) words_[first + f] = stream[f * capacity + i];
  }

  // Moves the last n rays into a stream, behind the `at` that are there.
  void take(float* stream, std::size_t capacity, std::size_t at, std::size_t n) {
    const std::size_t first = words_.size() - n * n_fields_;
    // A cache line of each field at a time.
    for (std::size_t from = 0; from < n; from += KDRAY_LANES)
      for (std::uint32_t f = 0; f < n_fields_; ++f)
        for (std::size_t i = from; i < std::min<std::size_t>(from + KDRAY_LANES, n); ++i)
          stream[f * capacity + at + i] = words_[first + i * n_fields_ + f];
    words_.resize(first);
  }

  // The last n, ray by ray; drop() takes them away, put_all() adds such.
  std::span<const float> last(std::size_t n) const { return std::span(words_).last(n * n_fields_); }
  void drop(std::size_t n) { words_.resize(words_.size() - n * n_fields_); }
  void put_all(std::span<const float> rays) { words_.insert(words_.end(), rays.begin(), rays.end()); }

  void take_all(RayPile& other) {
    if (words_.empty()) {
      words_.swap(other.words_);
    } else {
      words_.insert(words_.end(), other.words_.begin(), other.words_.end());
      other.words_.clear();
    }
  }

 private:
  std::uint32_t n_fields_;
  std::vector<float> words_;
};

// The rays that wait for a part.
struct HostRayQueue {
  std::vector<RayPile> rays;         // by slice
  std::vector<RayPile> shadow_rays;  // by slice
  std::uint64_t n = 0;               // of both
  std::uint32_t deepest = 0;         // depth of a ray that has come since there was none

  HostRayQueue(std::size_t n_slices, std::uint32_t ray_fields)
      : rays(n_slices, RayPile(ray_fields)), shadow_rays(n_slices, RayPile(KDRAY_TRAVEL_SHADOW_FIELDS)) {}

  std::uint64_t n_rays() const;

  // Ray i of a stream, as it is sent.
  void put_ray(std::size_t slice, const float* stream, std::size_t capacity, std::size_t i);
  void put_shadow_ray(std::size_t slice, const float* stream, std::size_t capacity, std::size_t i);
  // n rays of one depth as they lie in a pool; `stream` is left as they are sent.
  void put_pooled_rays(std::size_t slice, float* stream, std::size_t capacity, std::size_t n_rays,
                       std::uint32_t depth);

  // Takes all that is in the other, which has as many slices.
  void take_all(HostRayQueue& other);
};

// Puts the n rays of a stream, as they are sent, where the rays of the parts that they go to wait; nullptr:
// they are left.
void sort_rays(const float* stream, std::size_t capacity, std::size_t n, std::size_t slice,
               const std::function<HostRayQueue*(std::uint32_t)>& host_rays_of);
void sort_shadow_rays(const float* stream, std::size_t capacity, std::size_t n, std::size_t slice,
                      const std::function<HostRayQueue*(std::uint32_t)>& host_rays_of);

}  // namespace kdray::odprt
