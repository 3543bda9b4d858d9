// What    What a frame gets of the devices' memory: pools and buffers, the picture's bands, the number of
//         parts, and how many bytes of geometry a queue may hold at one time.
// Errors  ErrorCode::out_of_memory when a limit can't be kept, with the least that would do.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/odprt/division.h"
#include "engine/odprt/plan.h"
#include "engine/odprt/render.h"
#include "engine/odprt/worker.h"
#include "engine/wavefront/tile_order.h"
#include "layout/odprt.layout.h"

namespace kdray::odprt {

// A part may take this multiple of an equal share of the geometry, since some primitives lie in
// several parts and parts are of unequal size.
inline constexpr double kMostOfEqualShare = 1.3;

// The most parts that a ray can name.
inline constexpr std::uint32_t kMostParts = KDRAY_MAX_PARTS;

struct Provision {
  layout::Frame frame;  // with the plan's sizes
  BufferPlan plan;
  std::uint32_t n_parts = 0;
  std::size_t n_outboxes = 0;     // of a queue
  bool streamed = false;          // parts come and go
  std::size_t most_geometry = 0;  // of a queue, when streamed
  std::vector<wavefront::Band> bands;
  WorkCapacity capacity;  // of a queue: the largest band, or a round's samples
};

// There are as many parts as queues where that fits, and more, which come and go, where the request's limit
// is too small for it; then `least_parts` at least.
Provision provide(const Request& request, std::size_t geometry_bytes, std::uint32_t least_parts = 0);

// Whether every part is one that a queue may hold. Throws when one is not and there are as many parts as
// there can be.
bool fits(const Provision& provision, const Division& division, const Request& request);

}  // namespace kdray::odprt
