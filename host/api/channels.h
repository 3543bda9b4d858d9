// What    The channels that a frame is to have beside its colours.
#pragma once

#include <vector>

#include "api/job.h"
#include "api/state.h"
#include "io/image/image.h"

namespace kdray::api {

// Takes the counts of samples out of `frame_result`; they come last.
std::vector<image::Channel> channels_of(State& state, const Job& job, FrameResult& frame_result);

}  // namespace kdray::api
