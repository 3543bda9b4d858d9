// What    Renders a frame in PDPRT: the queues of all devices share its tiles.
#pragma once

#include "api/job.h"
#include "api/state.h"

namespace kdray::api {

FrameResult draw_pdprt(State& state, const Job& job);

}  // namespace kdray::api
