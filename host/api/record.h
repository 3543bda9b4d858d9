// What    Fills in the Statistics of a Renderer, or of a scene that is asked, from what its modules tell: the
//         scene, the tree, rays, samples, queues.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/prepare/prepared.h"
#include "api/job.h"
#include "api/state.h"
#include "engine/adaptive/plan.h"
#include "engine/odprt/render.h"
#include "engine/pdprt/render.h"
#include "kdray/kdray.h"
#include "kdray/statistics.h"
#include "layout/features.h"

namespace kdray::api {

// What is known before the first frame.
Statistics first_statistics(const engine::DeviceScene& devices);

Statistics::Features features_told(layout::Features mask);
Statistics::DeviceTuning tuning_told(const engine::Tuned& tuned);

// What a mode tells of a frame: the picture, how it was divided among the queues, what failed.
FrameResult frame_result_of(pdprt::Result&& result, const State& state, const Job& job);
FrameResult frame_result_of(odprt::Result&& result, const State& state, const Job& job);

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

// The names of choices, as the command line takes them and the statistics give them.
const char* name_of(Traversal traversal);
const char* name_of(Precision precision);
const char* name_of(Division division);
const char* name_of(Balance balance);

}  // namespace kdray::api
