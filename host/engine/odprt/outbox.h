// What    What a queue's launch sends: rays packed by the part and the slice that they go to, or by the slice
//         alone, in buffers on the device (kernels/odprt/send.clh), with their counts.
// Shape   A queue has several, so that it can go on while others still read the last one. Receivers whose
//         context is the same read the buffers themselves; for others, and for parts that nobody serves at
//         the moment, the rays are copied (host_ray_queue.h).
#pragma once

#include <atomic>
#include <cstdint>
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

}  // namespace kdray::odprt
