// What    Channel "queue": for each pixel who traced it. Of PDPRT that is the queue that rendered its tile,
//         of ODPRT the one whose subtree the eye ray through its centre ends in.
// Shape   The number of a queue, image::kNoQueue or image::kEveryQueue.
#pragma once

#include <span>
#include <vector>

#include "api/job.h"
#include "api/state.h"

namespace kdray::api {

std::vector<float> queues_by_tiles(const layout::Frame& frame, const Owners& owners);

// `depths`: of the world, along the rays of channel "depth".
std::vector<float> queues_by_subtrees(const State& state, const layout::Frame& frame, const Owners& owners,
                                      std::span<const float> depths);

}  // namespace kdray::api
