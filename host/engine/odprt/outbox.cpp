#include "engine/odprt/outbox.h"

#include <numeric>

#include "layout/rays.layout.h"

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

}  // namespace kdray::odprt
