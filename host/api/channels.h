// What    The channels that a frame is to have beside its colours.
#pragma once

#include <vector>

#include "api/job.h"
#include "api/state.h"
#include "io/image/image.h"

namespace kdray::api {

// Takes the counts of samples out of `drawn`; they come last.
std::vector<film::Channel> channels_of(State& state, const Job& job, Drawn& drawn);

}  // namespace kdray::api
