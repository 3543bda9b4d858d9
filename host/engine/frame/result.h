// What    What both schemes tell of a frame, and of the queues that have rendered it; and how another rank's
//         share of it comes to rank 0.
// Shape   A scheme's own structures are these and more.
// Errors  ErrorCode::internal: bytes that are no result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cluster/transport/message_bytes.h"
#include "engine/adaptive/plan.h"
#include "engine/wavefront/counters.h"

namespace kdray::frame {

struct QueueReport {
  std::size_t number = 0;  // among all queues, also those that are left out
  int rank = 0;            // that it is of
  std::string device;
  double busy_seconds = 0;
  std::uint64_t rays = 0;        // that it has traced
  std::size_t device_bytes = 0;  // without the scene
};

struct Result {
  std::uint32_t width = 0, height = 0;      // of the picture
  std::vector<float> rgb;                   // linear, row by row from the top left; rank 0 has it
  std::optional<adaptive::Report> samples;  // of adaptive sampling
  wavefront::Counters counters;
  std::map<std::string, double> stage_seconds;  // device time, added over the queues
  double render_seconds = 0;                    // wall time from the first launch to the finished picture
  std::uint32_t tile_width = 0, tile_height = 0, n_tiles = 0, n_bands = 0;
};

// The fields of a queue that travel, into or out of a stream.
template <class Stream, class Queue>
void pass_queue(Stream& stream, Queue& queue) {
  stream(queue.device, queue.busy_seconds, queue.rays, queue.device_bytes);
}

// What another rank adds to the result.
inline void put_share(const Result& result, transport::Writer& writer) {
  writer(result.counters, result.stage_seconds.size());
  for (const auto& [stage, seconds] : result.stage_seconds) writer(stage, seconds);
}
inline void add_share(transport::Reader& reader, Result& result) {
  result.counters.add(reader.get<wavefront::Counters>());
  for (auto n = reader.get<std::size_t>(); n > 0; --n) {
    const auto stage = reader.get<std::string>();
    result.stage_seconds[stage] += reader.get<double>();
  }
}

}  // namespace kdray::frame
