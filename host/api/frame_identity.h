// What    What tells a frame from others: for the checkpoint that is opened for it, and for ranks that render
//         it together and agree on it beforehand.
// Shape   A checkpoint's header says all that matters for the bits of a picture. Rank 0 sends it, and decides
//         the mode and how the frame is cut into tiles and bands.
// Errors  kdray::Error of a rank that has another scene, other settings or another build than rank 0, or less
//         memory for its film.
#pragma once

#include "api/job.h"
#include "api/state.h"

namespace kdray::api {

// Puts the tiles into the job's options. Returns rank 0's mode.
Mode agree(State& state, Job& job, Mode mode);

// What tells the frame from others.
checkpoint::Identity identity_of(State& state, const Job& job);

// For a job whose options ask for one. Puts the checkpoint's tiles into the job's options.
void open_checkpoint(State& state, Job& job);

}  // namespace kdray::api
