// What    Rays on their way to another rank, as a message's bytes and back.
// Shape   A head, then for each part and slice that there are any for: their numbers, the rays, the shadow
//         rays, each as the words of its fields (kernels/layout/rays.layout.h).
// Errors  ErrorCode::internal: bytes that are none, or rays of parts, slices, depths or pixels that there are
//         not. Kernels take these as they are, so all of them are looked at here.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cluster/transport/message_bytes.h"
#include "engine/odprt/outbox.h"

namespace kdray::odprt {

struct RaysHead {
  std::uint32_t list = 0, n_piles = 0;
};

// What a rank knows about the rays that may come to it.
struct RaysKnown {
  std::uint32_t first_part = 0, n_parts = 0;  // its own
  std::uint32_t n_all_parts = 0, n_slices = 0, ray_fields = 0, max_depth = 0;
  std::size_t first_pixel = 0, n_pixels = 0;  // of the film

  std::size_t n_counts() const { return std::size_t{n_slices} * (max_depth + 1); }
};

// Takes rays out of the queues of parts first_part, first_part + 1, ..., for `most_bytes` or a little more.
// `counts` (by slice and level) of those that it takes are added up.
transport::Bytes pack_rays(std::uint32_t list, std::uint32_t first_part, std::span<HostRayQueue> host_rays,
                           std::size_t most_bytes, std::span<std::uint32_t> counts);

// Puts them into the queues of the rank's own parts.
void unpack_rays(const transport::Message& message, const RaysKnown& known, std::span<HostRayQueue> host_rays,
                 std::span<std::uint32_t> counts);

}  // namespace kdray::odprt
