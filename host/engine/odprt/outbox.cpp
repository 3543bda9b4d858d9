#include "engine/odprt/outbox.h"

#include <bit>
#include <numeric>

namespace kdray::odprt {

Outbox::Outbox(const device::Context& context, const OutboxShape& shape)
    : shape_(shape),
      rays_(context.buffer(CL_MEM_READ_WRITE,
                           shape.n_streams() * shape.ray_fields * shape.ray_capacity * sizeof(float),
                           "the rays between queues")),
      shadow_rays_(
          context.buffer(CL_MEM_READ_WRITE,
                         shape.n_streams() * KDRAY_SENT_SHADOW_FIELDS * shape.shadow_capacity * sizeof(float),
                         "the shadow rays between queues")),
      counts_(context.buffer(CL_MEM_READ_WRITE, 2 * shape.n_streams() * sizeof(layout::u32), "their counts")),
      n_(2 * shape.n_streams()) {}

std::size_t Outbox::bytes() const {
  return shape_.n_streams() *
         (std::size_t{shape_.ray_fields} * shape_.ray_capacity * sizeof(float) +
          std::size_t{KDRAY_SENT_SHADOW_FIELDS} * shape_.shadow_capacity * sizeof(float) +
          2 * sizeof(layout::u32));
}

std::uint64_t Outbox::n_all() const {
  return std::accumulate(n_.begin(), n_.end(), std::uint64_t{0});
}

std::uint64_t Outbox::sum(std::uint32_t row) const {
  const auto first = n_.begin() + static_cast<std::ptrdiff_t>(std::size_t{row} * shape_.n_slices);
  return std::accumulate(first, first + shape_.n_slices, std::uint64_t{0});
}

namespace {

std::uint32_t word_at(const float* stream, std::size_t capacity, std::uint32_t field, std::size_t i) {
  return std::bit_cast<std::uint32_t>(stream[field * capacity + i]);
}

}  // namespace

std::uint64_t HostRayQueue::n_rays() const {
  return std::accumulate(rays.begin(), rays.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const auto& pile) { return sum + pile.size(); });
}

void HostRayQueue::put_ray(std::size_t slice, const float* stream, std::size_t capacity, std::size_t i) {
  deepest = std::max(deepest, KDRAY_FINDER_DEPTH(word_at(stream, capacity, KDRAY_RAY_FINDER, i)));
  rays[slice].put(stream, capacity, i);
  ++n;
}

void HostRayQueue::put_shadow_ray(std::size_t slice, const float* stream, std::size_t capacity,
                                  std::size_t i) {
  shadow_rays[slice].put(stream, capacity, i);
  ++n;
}

void HostRayQueue::put_pooled_rays(std::size_t slice, float* stream, std::size_t capacity, std::size_t n_rays,
                                   std::uint32_t depth) {
  float* const words = stream + KDRAY_RAY_FINDER * capacity;
  for (std::size_t i = 0; i < n_rays; ++i) {
    words[i] = std::bit_cast<float>(KDRAY_FINDER(std::bit_cast<std::uint32_t>(words[i]), depth));
    put_ray(slice, stream, capacity, i);
  }
}

void HostRayQueue::take_all(HostRayQueue& other) {
  for (std::size_t s = 0; s < rays.size(); ++s) {
    rays[s].take_all(other.rays[s]);
    shadow_rays[s].take_all(other.shadow_rays[s]);
  }
  n += other.n;
  deepest = std::max(deepest, other.deepest);
  other.n = 0;
  other.deepest = 0;
}

void sort_rays(const float* stream, std::size_t capacity, std::size_t n, std::size_t slice,
               const std::function<HostRayQueue*(std::uint32_t)>& host_rays_of) {
  for (std::size_t i = 0; i < n; ++i)
    if (HostRayQueue* const host_rays =
            host_rays_of(KDRAY_FINDER_GOES_TO(word_at(stream, capacity, KDRAY_RAY_FINDER, i))))
      host_rays->put_ray(slice, stream, capacity, i);
}

void sort_shadow_rays(const float* stream, std::size_t capacity, std::size_t n, std::size_t slice,
                      const std::function<HostRayQueue*(std::uint32_t)>& host_rays_of) {
  for (std::size_t i = 0; i < n; ++i)
    if (HostRayQueue* const host_rays = host_rays_of(word_at(stream, capacity, KDRAY_SENT_SHADOW_TO, i)))
      host_rays->put_shadow_ray(slice, stream, capacity, i);
}

}  // namespace kdray::odprt
