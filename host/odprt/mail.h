// What    Rays on their way through the host's memory: between contexts, and to parts that nobody serves at the moment.
// Shape   For each slice the rays that wait, as structures of their fields (kernels/layout/rays.layout.h), taken from the end.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "layout/rays.layout.h"
#include "odprt/outbox.h"

namespace kdray::odprt {

// kFields words to a ray.
template <std::uint32_t kFields>
class RayPile {
 public:
  std::size_t size() const { return words_.size() / kFields; }

  // n rays of a stream: field f of ray i at stream[f*capacity + i].
  void put(const float* stream, std::size_t capacity, std::size_t n) {
    const std::size_t first = words_.size();
    words_.resize(first + n * kFields);
    for (std::uint32_t f = 0; f < kFields; ++f)
      for (std::size_t i = 0; i < n; ++i) words_[first + i * kFields + f] = stream[f * capacity + i];
  }

  // Moves the last n rays into a stream, behind the `at` that are there.
  void take(float* stream, std::size_t capacity, std::size_t at, std::size_t n) {
    const std::size_t first = words_.size() - n * kFields;
    for (std::size_t i = 0; i < n; ++i)
      for (std::uint32_t f = 0; f < kFields; ++f)
        stream[f * capacity + at + i] = words_[first + i * kFields + f];
    words_.resize(first);
  }

  void take_all(RayPile& other) {
    if (words_.empty()) {
      words_.swap(other.words_);
    } else {
      words_.insert(words_.end(), other.words_.begin(), other.words_.end());
      other.words_.clear();
    }
  }

 private:
  std::vector<float> words_;
};

// What waits for a part.
struct Mail {
  std::vector<RayPile<KDRAY_TRAVEL_RAY_FIELDS>> rays;            // by slice
  std::vector<RayPile<KDRAY_TRAVEL_SHADOW_FIELDS>> shadow_rays;  // by slice
  std::uint64_t n = 0;                                           // of both
  std::uint32_t deepest = 0;  // depth of a ray that has come since there was none

  explicit Mail(std::size_t n_slices) : rays(n_slices), shadow_rays(n_slices) {}

  // n rays as they are sent.
  void put_rays(std::size_t slice, const float* stream, std::size_t capacity, std::size_t n_rays);
  // n rays of one depth as they lie in a pool; `stream` is left as they are sent.
  void put_pooled_rays(std::size_t slice, float* stream, std::size_t capacity, std::size_t n_rays,
                       std::uint32_t depth);
  void put_shadow_rays(std::size_t slice, const float* stream, std::size_t capacity, std::size_t n_rays);

  // Takes all that is in the other, which has as many slices.
  void take_all(Mail& other);
};

}  // namespace kdray::odprt
