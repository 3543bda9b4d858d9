// What    Renders a frame: in PDPRT the queues of all devices share its tiles, in ODPRT the scene's
//         subtrees.
#pragma once

#include <span>
#include <vector>

#include "api/job.h"
#include "api/state.h"
#include "io/image/image.h"

namespace kdray::api {

FrameResult draw_pdprt(State& state, const Job& job);

// Writes the schedule into the job's frame. Errors: ErrorCode::usage for what ODPRT does not do: the binary
// walk, and channels within a limit of memory.
FrameResult draw_odprt(State& state, Job& job);

// The channels that a frame is to have beside its colours. Channel "queue" tells of each pixel who traced
// it. Of PDPRT that is the queue that rendered its tile, of ODPRT the one whose subtree the eye ray through
// its centre ends in: a queue's number, image::kNoQueue or image::kEveryQueue.
std::vector<float> queues_by_tiles(const layout::Frame& frame, const Owners& owners);

// `depths`: of the world, along the rays of channel "depth".
std::vector<float> queues_by_subtrees(const State& state, const layout::Frame& frame, const Owners& owners,
                                      std::span<const float> depths);

// Takes the counts of samples out of `frame_result`; they come last.
std::vector<image::Channel> channels_of(State& state, const Job& job, FrameResult& frame_result);

}  // namespace kdray::api
