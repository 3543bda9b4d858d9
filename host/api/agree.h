// What    What ranks agree on before a frame: that it is the same one for all, in which mode, and how it is
//         cut into tiles and bands, which rank 0 decides.
// Shape   A checkpoint's header says all that matters for the bits of a picture; rank 0 sends it.
// Errors  kdray::Error of a rank that has another scene, other settings or another build than rank 0, or less
//         memory for its film.
#pragma once

#include "api/job.h"
#include "api/state.h"

namespace kdray::api {

// Puts the tiles into the job's options. Returns rank 0's mode.
Mode agree(State& state, Job& job, Mode mode);

}  // namespace kdray::api
