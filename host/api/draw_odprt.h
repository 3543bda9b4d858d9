// What    Renders a frame in ODPRT: the queues of all devices share the scene's subtrees.
// Errors  ErrorCode::usage for what ODPRT does not do: the binary walk, and channels within a limit of
//         memory.
#pragma once

#include "api/job.h"
#include "api/state.h"

namespace kdray::api {

// Writes the schedule into the job's frame.
FrameResult draw_odprt(State& state, Job& job);

}  // namespace kdray::api
