// What    Fills in the Statistics of a Renderer, or of a scene that is asked, from what its modules tell: the
//         scene, the tree, rays, samples, queues.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/prepare/prepared.h"
#include "api/job.h"
#include "api/state.h"
#include "engine/adaptive/report.h"
#include "engine/odprt/render.h"
#include "engine/pdprt/render.h"
#include "kdray/statistics.h"
#include "layout/features.h"

namespace kdray::api {

// What is known before the first frame.
Statistics first_statistics(const engine::DeviceScene& devices);

Statistics::Features features_told(layout::Features mask);
Statistics::DeviceTuning tuning_told(const engine::Tuned& tuned);

// How a frame was divided among the queues, as far as the mode knows.
Statistics::Division division_of(const pdprt::Result& result, const Job& job, bool global);
// `bytes_of_whole` is the scene's geometry.
Statistics::Division division_of(const odprt::Result& result, const Job& job, std::uint64_t bytes_of_whole);

// What this rank has sent, and whose each queue is.
template <class Queues>
void tell_of_ranks(Statistics::Division& division, const Queues& queues, const transport::Ranks& ranks) {
  const transport::Counters& c = ranks.counters();
  division.ranks = Statistics::Ranks{ranks.size(), c.sent, c.received, c.bytes_sent, c.bytes_received};
  for (std::size_t i = 0; i < queues.size(); ++i) division.per_queue[i].rank = queues[i].rank;
}

// What all modes tell of a frame.
void record_frame(Statistics& statistics, const State& state, const Job& job, FrameResult& frame_result,
                  const std::string& why);

struct Query {
  std::uint64_t rays = 0, repeat = 0;
  double seconds = 0;
  Traversal traversal = Traversal::automatic;
  Precision precision = Precision::float32;
};
void record_query(Statistics& statistics, const engine::DeviceScene& devices, const Query& query);

}  // namespace kdray::api
