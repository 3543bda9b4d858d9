// What    Opens the checkpoint of a frame: what tells it from others, and the tiles that it has.
#pragma once

#include "api/job.h"
#include "api/state.h"

namespace kdray::api {

// What tells the frame from others.
checkpoint::Identity identity_of(State& state, const Job& job);

// For a job whose options ask for one. Puts the checkpoint's tiles into the job's options.
void open_checkpoint(State& state, Job& job);

}  // namespace kdray::api
