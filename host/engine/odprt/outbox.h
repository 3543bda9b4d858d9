// What    What a queue's launch sends: rays packed by the part and the slice that they go to, or by the slice
//         alone, in buffers on the device (kernels/odprt/send.clh), with their counts.
// Shape   A queue has several, so that it can go on while others still read the last one. Receivers whose
//         context is the same read the buffers themselves; for others, and for parts that nobody serves at
//         the moment, the rays are copied (HostRayQueue).
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "device/opencl/context.h"
#include "layout/odprt.layout.h"
#include "layout/rays.layout.h"

namespace kdray::odprt {

// Rays for each place and slice, and the words per field that they take.
struct OutboxShape {
  std::uint32_t n_places = 0;  // one for each part, or one for all of them, where the host sorts the rays
  std::uint32_t n_slices = 0;
  std::uint32_t rays = 0, ray_capacity = 0, shadow = 0, shadow_capacity = 0;
  std::uint32_t ray_fields = KDRAY_TRAVEL_RAY_FIELDS;  // words of a ray (travel_ray_fields)

  std::size_t n_streams() const { return std::size_t{n_places} * n_slices; }
};

class Outbox {
 public:
  Outbox(const device::Context& context, const OutboxShape& shape);

  const OutboxShape& shape() const { return shape_; }
  const cl::Buffer& rays() const { return rays_; }
  const cl::Buffer& shadow_rays() const { return shadow_rays_; }
  const cl::Buffer& counts() const { return counts_; }
  std::size_t bytes() const;

  // For a kernel that fills the outbox, or takes rays out of it.
  template <template <class> class Kernel, class K>
  void set_arguments(Kernel<K>& kernel) const {
    kernel.set(K::sent_rays, rays_).set(K::sent_shadow_rays, shadow_rays_).set(K::sent_counts, counts_);
  }

  // The counts as the last launch left them, read by the queue that sends: rays, then shadow rays, by place
  // and slice.
  std::vector<layout::u32>& n() { return n_; }
  const std::vector<layout::u32>& n() const { return n_; }
  std::uint64_t n_rays(std::uint32_t place) const { return sum(place); }
  std::uint64_t n_shadow_rays(std::uint32_t place) const { return sum(shape_.n_places + place); }
  std::uint64_t n_all() const;

  // Receivers that haven't read it yet; it is written to again when there are none.
  std::atomic<int> n_readers{0};

 private:
  std::uint64_t sum(std::uint32_t row) const;

  OutboxShape shape_;
  cl::Buffer rays_, shadow_rays_, counts_;
  std::vector<layout::u32> n_;
};

// Rays on their way through the host's memory: between contexts, and to parts that nobody serves at the
// moment. For each slice the rays that wait, as structures of their fields (kernels/layout/rays.layout.h),
// taken from the end.

// The rays that wait of one slice: n_fields words to a ray.
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
  void put_all(std::span<const float> rays) {
    const std::size_t first = words_.size();
    words_.resize(first + rays.size());
    std::copy(rays.begin(), rays.end(), words_.begin() + static_cast<std::ptrdiff_t>(first));
  }

  void take_all(RayPile& other) {
    if (words_.empty()) {
      words_.swap(other.words_);
    } else {
      put_all(other.words_);
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
