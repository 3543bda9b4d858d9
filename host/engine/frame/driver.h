// What    Renders a frame by an executor: all its tiles, band by band, and with adaptive sampling rounds of
//         samples; with a checkpoint only what that lacks; and tells the progress.
// Shape   A round is what is finished together: all tiles, or all runs of a list of samples. It is cut into
//         stretches, for which the films have places, and each stretch is a list of the executor's.
// Errors  Those of the executor, of the checkpoint and of Request::progress.
// Source  docs/design/checkpoint.md and adaptive.md.
#pragma once

#include "engine/frame/executor.h"
#include "engine/frame/result.h"

namespace kdray::frame {

// Fills in the picture, its samples, the time, and how it was cut. On ranks other than 0 there is no picture.
void render_frame(Executor& executor, const Request& request, Result& result);

}  // namespace kdray::frame
